// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lighting/harmonics.h"
#include "lighting/polar_map.h"

namespace lightwell {

// Radiance as spherical harmonics to degree 4, RGB: row l(l + 1) + m of lighting/harmonics.h, cd/m².
inline constexpr int kRadianceDegree = 4;
using RadianceHarmonics = Eigen::Array<double, harmonic_count(kRadianceDegree), 3>;

// Irradiance of a surface with this unit normal: Σ A_l L_lm Y_lm. Of the whole sphere's radiance it leaves out what a
// Lambertian surface keeps beyond degree 4, .2 % of the energy where all light comes from one place; it may be a little below 0.
Rgbd irradiance(const RadianceHarmonics& radiance, const Vec3d& normal) noexcept;

// Projects a map: L_lm = Σ_bins L Ω Y_lm, every bin a light in its centre, nothing where nothing was measured. Its
// irradiance is that of the measured part to degree 4, with no window and no fit to a part of the sphere.
// A ring's azimuths take part in nine sums for all harmonics: 90 × 360 bins of RGB take .16 ms.
class MapHarmonics {
 public:
  explicit MapHarmonics(const PolarGrid& grid);
  // map: of this grid; what is not finite and positive counts as 0. Allocates nothing.
  const RadianceHarmonics& project(const PolarMap& map) noexcept;

 private:
  static constexpr int kOrders = kRadianceDegree + 1;
  PolarGrid grid_;
  Eigen::MatrixXd cosines_;  // [sectors / 2, rounded up][orders]: cos mλ of the azimuths up to π
  Eigen::MatrixXd sines_;
  Eigen::MatrixXd zonal_;       // [rings][25]: Y_lm at azimuth 0, of −m where m < 0
  Eigen::VectorXd even_, odd_;  // a ring's light at λ plus, and less, that at −λ
  RadianceHarmonics result_;
};

}  // namespace lightwell
