// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "lighting/polar_map.h"

namespace lightwell {

using Directions = Eigen::Matrix<double, 3, Eigen::Dynamic>;  // one unit vector a column

// A map as few weighted directions: what placing lights works on instead of its bins.
// Scaled so that the map's total luminance is 1, whatever the map's own range.
struct Atoms {
  Directions direction;                                  // luminance-weighted mean of the atom's bins
  Eigen::Matrix<double, Eigen::Dynamic, 3> illuminance;  // RGB, Σ over atoms = total / scale
  Eigen::VectorXd luminance;                             // of the illuminance; sums to 1
  Eigen::VectorXd solid_angle_sr;
  double scale = 0;  // luminance of the map's total illuminance, lux; 0: the map is black, there are no atoms
  Rgbd total = Rgbd::Zero();  // the map's total illuminance, lux

  [[nodiscard]] Eigen::Index size() const { return luminance.size(); }
};

struct AtomOptions {
  double coarse_share =
      1.0 / 1500;  // blocks of 6° x 12° with more of the total than this are divided into 3° x 6°,
  double fine_share =
      1.0 / 800;  // and those with more than this into 1° x 1° (or bins, where they are larger)
};

// Adaptive blocks of the map; near the poles they are wider in azimuth. Black blocks give no atom; values
// that are not finite and positive count as 0. Between 30 and a few thousand atoms whatever the map's size.
Atoms make_atoms(const PolarMap& map, const AtomOptions& options = {});

// At most `count` atoms that stand for all of them: the brightest group is divided in two at its luminance's median,
// along the axis in which it is widest, until there are enough (a median cut of points). Order: by division.
Atoms merge_atoms(const Atoms& atoms, Eigen::Index count);

}  // namespace lightwell
