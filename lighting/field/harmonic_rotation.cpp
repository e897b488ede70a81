// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/harmonic_rotation.h"

#include <cmath>

#include "lighting/direction.h"
#include "lighting/field/gauss_legendre.h"
#include "lighting/result.h"

namespace lightwell {
HarmonicRotation::HarmonicRotation(const Eigen::Matrix3d& rotation, int degree) {
  verify_bug(degree >= 0 && degree <= kMostDegree, "degree of spherical harmonics out of range");
  for (int l = 0; l <= degree; ++l) bands_.emplace_back(Eigen::MatrixXd::Zero(2 * l + 1, 2 * l + 1));
  // Products of two harmonics have degree 2 · degree: this many heights and azimuths integrate them exactly.
  const GaussLegendre heights = gauss_legendre(degree + 1);
  const int azimuths = 2 * degree + 1;
  Eigen::VectorXd here(harmonic_count(degree)), turned(harmonic_count(degree));
  for (int i = 0; i <= degree; ++i)
    for (int j = 0; j < azimuths; ++j) {
      const Vec3d direction = direction_from_spherical({std::acos(heights.nodes[i]), 2 * kPi * j / azimuths});
      harmonics(direction, degree, here.data());
      harmonics((rotation * direction).normalized(), degree, turned.data());
      const double weight = heights.weights[i] * 2 * kPi / azimuths;
      for (int l = 0; l <= degree; ++l)
        bands_[static_cast<std::size_t>(l)] +=
            weight * turned.segment(l * l, 2 * l + 1) * here.segment(l * l, 2 * l + 1).transpose();
    }
}

Eigen::MatrixXd HarmonicRotation::apply(const Eigen::MatrixXd& coefficients) const {
  Eigen::MatrixXd out(coefficients.rows(), coefficients.cols());
  for (std::size_t l = 0; l < bands_.size(); ++l) {
    const auto first = static_cast<Eigen::Index>(l * l);
    out.middleRows(first, bands_[l].rows()) = bands_[l] * coefficients.middleRows(first, bands_[l].rows());
  }
  return out;
}

}  // namespace lightwell
