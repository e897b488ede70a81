// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lighting/evaluation/occluder.h"
#include "lighting/polar_map.h"

namespace lightwell {

// Where light sets are compared with maps: what depends on a grid and an occluder but on no radiance, made once
// and shared by all frames of a sequence.
//
// The reference is exact, not sampled: every bin is a light in its centre. Along a ring both a cosine's positive
// part and what the occluder hides are one run of sectors, so differences of running sums over the sectors give
// the sum over all bins in O(rings) a point; the runs' ends are kept here.
class EvaluationGeometry {
 public:
  explicit EvaluationGeometry(const PolarGrid& grid, Occluder occluder = Occluder::sphere);

  // map: of the grid given. values: one a normal (evaluation_normals), resized.
  void irradiance(const PolarMap& map, std::vector<Rgbd>& values) const;
  // The horizontal irradiance of the ground, one value a point (evaluation_ground), resized.
  void shadow(const PolarMap& map, std::vector<Rgbd>& values) const;

  [[nodiscard]] const PolarGrid& grid() const { return grid_; }
  [[nodiscard]] Occluder occluder() const { return occluder_; }

 private:
  // Sectors first … first + count − 1, running on past the seam. count may be all of them.
  struct Run {
    std::int32_t first = 0;
    std::int32_t count = 0;
  };
  [[nodiscard]] Run run_of(const AzimuthArc& arc) const;

  PolarGrid grid_;
  Occluder occluder_;
  std::vector<Vec3d> normals_;
  std::vector<Run> lit_;           // [rings][normals]
  std::vector<Run> hidden_;        // [rings][ground points]
  std::vector<Vec2d> azimuths_;    // sine and cosine of every sector's centre
  std::vector<double> sin_theta_;  // of every ring's middle
  std::vector<double> cos_theta_;
};

// The 642 normals: y falls in equal steps, azimuth grows by the golden angle.
std::vector<Vec3d> evaluation_normals();
// 64×64 points of the plane y = 0, spacing 6/64, centred: rows along z, columns along x.
std::vector<Vec3d> evaluation_ground();

}  // namespace lightwell
