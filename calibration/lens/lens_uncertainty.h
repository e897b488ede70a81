// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "calibration/lens/lens_calibration.h"
#include "lighting/lens.h"

namespace lightwell::calibration {

// How sure the pixel of a direction is, given the covariance of the lens. A lens and a camera turned a little
// against it project alike, and no calibration tells them apart: the turn that undoes most of an error over the
// field is taken out first (the idea of mrcal's projection uncertainty, there with poses of the boards).
class ProjectionUncertainty {
 public:
  // The field: every direction up to lens.max_theta_rad, equal solid angles weighing equally.
  ProjectionUncertainty(const Lens& lens, const Eigen::Matrix<double, 8, 8>& covariance);

  // Covariance of the pixel, px².
  [[nodiscard]] Eigen::Matrix2d covariance_px2(const Vec3d& direction) const;
  // Standard deviation along the worst axis, px.
  [[nodiscard]] double worst_px(const Vec3d& direction) const;
  // The turn (radians about x, y, z of the camera) that undoes most of a change of the lens.
  [[nodiscard]] Vec3d undoing_turn(const Eigen::Matrix<double, 8, 1>& change) const {
    return turn_dlens_ * change;
  }

 private:
  Lens lens_;
  Eigen::Matrix<double, 8, 8> covariance_;
  Eigen::Matrix<double, 3, 8> turn_dlens_;
};

}  // namespace lightwell::calibration
