// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/direction_estimator.h"

#include <algorithm>
#include <cmath>

#include "lighting/field/gaussian_splat.h"
#include "lighting/result.h"

namespace lightwell {
namespace {

// The plane is a little finer than the rays lie, and no coarser than the grid: what linear interpolation between its pixels
// smooths is then less than what the rays can tell.
int pixels_a_cell_for(const FieldGrid& grid, std::size_t probes) {
  constexpr int kMost = 4;
  const Vec3d n(grid.size[0], grid.size[1], grid.size[2]);
  const double cells = std::max({n.x() * n.y(), n.y() * n.z(), n.z() * n.x()});
  return std::clamp(static_cast<int>(std::lround(std::sqrt(2 * static_cast<double>(probes) / cells))), 1,
                    kMost);
}

}  // namespace

DirectionEstimator::DirectionEstimator(const FieldGrid& grid, std::span<const Vec3d> positions,
                                       FieldMethod method, int support)
    : grid_(grid),
      positions_(positions),
      method_(method),
      support_(support),
      pixels_a_cell_(method == FieldMethod::low ? 2 : pixels_a_cell_for(grid, positions.size())) {
  verify_bug(!positions.empty(), "a field of no probes");
}

ShearPlane DirectionEstimator::project(const MeasuredDirection& direction, std::span<const Rgb> radiance) {
  verify_bug(radiance.size() == positions_.size(), "one radiance a probe");
  const ShearPlane plane(grid_, direction.direction, pixels_a_cell_);
  samples_.clear();
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    if (std::isnan(radiance[i].x())) continue;
    const Vec3d at = grid_.grid_from_world(positions_[i] + direction.origin);
    samples_.push_back({plane.across(plane.pixel_of(at)).cast<float>(), radiance[i]});
  }
  return plane;
}

void DirectionEstimator::estimate(const MeasuredDirection& direction, std::span<const Rgb> radiance,
                                  FieldDirection& out) {
  out.plane = project(direction, radiance);
  if (method_ == FieldMethod::low || samples_.empty()) {
    gaussian_splat(out.plane, samples_, out.image);
    return;
  }
  nearest_.build(samples_);
  fits_.fit(out.plane, nearest_, support_, out.image);
}

void DirectionEstimator::hold_out(const MeasuredDirection& direction, std::span<const Rgb> radiance,
                                  SupportChoice& choice) {
  (void)project(direction, radiance);
  if (samples_.empty()) return;
  nearest_.build(samples_);
  choice.add(nearest_);
}

void DirectionEstimator::check(const MeasuredDirection& direction, std::span<const Rgb> radiance,
                               RayConsistency& consistency) {
  (void)project(direction, radiance);
  if (samples_.empty()) return;
  nearest_.build(samples_);
  consistency.add(nearest_, radiance, support_);
}

}  // namespace lightwell
