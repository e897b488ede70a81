// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/shear_plane.h"

#include <algorithm>
#include <cmath>

namespace lightwell {

ShearPlane::ShearPlane(const FieldGrid& grid, const Vec3d& direction, int pixels_a_cell)
    : pixels_a_cell_(pixels_a_cell) {
  const Vec3d d = direction.cwiseQuotient(grid.cell()).normalized();
  int main = 0;
  d.cwiseAbs().maxCoeff(&main);
  axes_ = {main == 0 ? 1 : 0, main == 2 ? 1 : 2, main};
  slices_ = grid.size[static_cast<std::size_t>(main)];
  middle_ = (grid.size[static_cast<std::size_t>(main)] - 1) / 2.0;
  for (int i = 0; i < 2; ++i) {
    const int axis = axes_[static_cast<std::size_t>(i)];
    points_[static_cast<std::size_t>(i)] = grid.size[static_cast<std::size_t>(axis)];
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

void ShearPlane::read_columns(std::vector<std::array<int, 2>>& rows) const {
  rows.assign(static_cast<std::size_t>(size_[1]), {size_[0], 0});
  for (int slice = 0; slice < slices_; ++slice) {
    const Vec2d first = slice_origin(slice).cwiseMax(0.0);
    const Vec2d last = first + pixels_a_cell_ * Vec2d(points_[0] - 1, points_[1] - 1);
    const int x0 = static_cast<int>(first.x()), x1 = std::min(static_cast<int>(last.x()) + 2, size_[0]);
    const int y0 = static_cast<int>(first.y()), y1 = std::min(static_cast<int>(last.y()) + 2, size_[1]);
    for (int y = y0; y < y1; ++y) {
      auto& [begin, end] = rows[static_cast<std::size_t>(y)];
      begin = std::min(begin, x0);
      end = std::max(end, x1);
    }
  }
}

void PlaneImage::resize(int w, int h) {
  width = w;
  height = h;
  channels.assign(4 * pixels() + kBehind, 0.0f);
}

}  // namespace lightwell
