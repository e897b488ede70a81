// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lighting/fit/fit_observations.h"
#include "lighting/fit/variable_projection.h"

namespace lightwell {

// Standard deviations of a fit, in the trial's own units and radians; infinite where nothing holds the value.
struct FitSigmas {
  std::array<double, kMostFittedLights> direction_rad{};  // root mean square of the two angles'
  Eigen::Array<double, kMostFittedLights, 3> power;       // 0 for powers that are held at 0
};

// From (JᵀJ)⁻¹ over all free parameters, both angles of every light and all positive powers, times cost / 9.
// Allocates nothing.
class FitConfidence {
 public:
  explicit FitConfidence(const FitObservations& observations);
  FitSigmas sigmas(const LightsTrial& trial) noexcept;

 private:
  static constexpr int kMostParameters = 2 * kMostFittedLights + 3 * kMostUnknowns;
  const FitObservations& observations_;
  Eigen::MatrixXd columns_;  // [rows][values, then slopes along t and u]
  Eigen::MatrixXd products_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostParameters, kMostParameters>
      normal_, inverse_;
};

}  // namespace lightwell
