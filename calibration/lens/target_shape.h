// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "calibration/lens/correspondences.h"

namespace lightwell::calibration {

// How a printed board differs from the flat, square grid it should be: printers stretch and shear, paper and
// plates bend. With x, y the place on the board from its middle, in units of half its width:
// dX = stretch x + shear y, dZ = bow_x x² + bow_y y² + twist x y, millimetres.
struct TargetShape {
  Vec3d middle_mm = Vec3d::Zero();
  double half_mm = 1;
  Eigen::Matrix<double, 5, 1> change_mm =
      Eigen::Matrix<double, 5, 1>::Zero();  // stretch, shear, bow_x, bow_y, twist

  // Change of a place by each of the five.
  [[nodiscard]] Eigen::Matrix<double, 3, 5> basis(const Vec3d& target_mm) const {
    const double x = (target_mm.x() - middle_mm.x()) / half_mm, y = (target_mm.y() - middle_mm.y()) / half_mm;
    Eigen::Matrix<double, 3, 5> b = Eigen::Matrix<double, 3, 5>::Zero();
    b.row(0) << x, y, 0, 0, 0;
    b.row(2) << 0, 0, x * x, y * y, x * y;
    return b;
  }
  [[nodiscard]] Vec3d place(const Vec3d& target_mm) const { return target_mm + basis(target_mm) * change_mm; }
};

// The square shape around the points of all views.
inline TargetShape square_shape(std::span<const TargetView> views) {
  Vec3d least = Vec3d::Constant(1e300), most = -least;
  for (const TargetView& view : views)
    for (const auto& p : view.points) {
      least = least.cwiseMin(p.target_mm);
      most = most.cwiseMax(p.target_mm);
    }
  TargetShape shape;
  shape.middle_mm = (least + most) / 2;
  shape.half_mm = std::max(1e-9, (most - least).maxCoeff() / 2);
  return shape;
}

}  // namespace lightwell::calibration
