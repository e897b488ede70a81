// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/shear_plane.h"

#include <cmath>

namespace lightwell {

ShearPlane::ShearPlane(const FieldGrid& grid, const Vec3d& direction, int pixels_a_cell)
    : pixels_a_cell_(pixels_a_cell) {
  const Vec3d d = direction.cwiseQuotient(grid.cell()).normalized();
  int main = 0;
  d.cwiseAbs().maxCoeff(&main);
  axes_ = {main == 0 ? 1 : 0, main == 2 ? 1 : 2, main};
  middle_ = (grid.size[static_cast<std::size_t>(main)] - 1) / 2.0;
  for (int i = 0; i < 2; ++i) {
    const int axis = axes_[static_cast<std::size_t>(i)];
    slope_[i] = d[axis] / d[main];
    start_[i] = -std::abs(slope_[i]) * middle_;
    // One more than covers the grid: linear interpolation reads the pixel after the last.
    size_[static_cast<std::size_t>(i)] =
        2 + static_cast<int>(
                std::ceil((grid.size[static_cast<std::size_t>(axis)] - 1 - 2 * start_[i]) * pixels_a_cell));
  }
  // |offset|² − (offset · d)²: along the direction's trace in the plane lengths shrink by its part along the main axis.
  const Vec2d trace(d[axes_[0]], d[axes_[1]]);
  across_from_pixel_.setIdentity();
  if (const double n = trace.squaredNorm(); n > 0)
    across_from_pixel_ += (std::abs(d[main]) - 1) / n * trace * trace.transpose();
  across_from_pixel_ /= pixels_a_cell;
}

Vec2d ShearPlane::pixel_of(const Vec3d& p) const {
  const double depth = p[axes_[2]] - middle_;
  return pixels_a_cell_ * (Vec2d(p[axes_[0]], p[axes_[1]]) - slope_ * depth - start_);
}

Vec2d ShearPlane::slice_origin(int slice) const {
  return pixels_a_cell_ * (-slope_ * (slice - middle_) - start_);
}

void PlaneImage::resize(int w, int h) {
  width = w;
  height = h;
  channels.assign(4 * pixels(), 0.0f);
}

}  // namespace lightwell
