// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/live_sums.h"

#include <algorithm>
#include <cmath>

#include "lighting/field/live_kernel/kernel.h"

namespace lightwell {
namespace {

using live_kernel::kLanes;

constexpr std::size_t kBatch = 64;  // directions of a slab that stay in the cache

std::size_t rounded_up(std::size_t count) {
  return (count + kLanes - 1) / kLanes * kLanes;
}

// Not a multiple of 4096 bytes, so that equal places of neighbouring directions do not share a line of the cache.
std::size_t slab_stride(const FieldGrid& grid) {
  const std::size_t points =
      rounded_up(3 * static_cast<std::size_t>(grid.size[0]) * static_cast<std::size_t>(grid.size[1]));
  return points / 16 % 2 == 0 ? points + 16 : points;
}

}  // namespace

LiveSums::LiveSums(const FieldGrid& grid, int degree, std::span<const RayKriging> directions,
                   const Eigen::MatrixXd& harmonics)
    : grid_(grid), degree_(degree), probes_(static_cast<std::size_t>(directions.front().weights.cols())) {
  std::size_t image = 0;
  for (const RayKriging& of : directions) {
    const auto pixels = static_cast<std::size_t>(of.weights.rows());
    const std::size_t padded = rounded_up(pixels);
    Direction direction{of.plane, of.plane.width(), static_cast<int>(padded), {}, image};
    direction.weights.assign(padded * probes_, 0.0f);
    for (std::size_t n = 0; n < probes_; ++n)
      std::copy_n(of.weights.col(static_cast<Eigen::Index>(n)).data(), pixels,
                  direction.weights.data() + n * padded);
    image += 3 * padded;
    directions_.push_back(std::move(direction));
  }
  // A run's vectors may read a register beyond the last row.
  images_.assign(image + static_cast<std::size_t>(grid.longest_side()) + 2 * kLanes, 0.0f);
  const Eigen::MatrixXf single = harmonics.cast<float>();
  harmonics_.assign(single.data(), single.data() + single.size());
  slab_.assign(kBatch * slab_stride(grid), 0.0f);
  sums_.assign(
      static_cast<std::size_t>(harmonic_count(degree)) *
          rounded_up(3 * static_cast<std::size_t>(grid.size[0]) * static_cast<std::size_t>(grid.size[1])),
      0.0f);
}

// Three channels of a direction at all points of slab z.
void LiveSums::look_up_slab(const Direction& direction, int z, float* out) const {
  const auto& kernels = live_kernel::kernels();
  const int nx = grid_.size[0], ny = grid_.size[1];
  const auto run = [&](const Vec2d& at, int count, int stride, float* to) {
    const double left = std::floor(at.x()), top = std::floor(at.y());
    const auto fx = static_cast<float>(at.x() - left), fy = static_cast<float>(at.y() - top);
    const auto pixel = static_cast<std::ptrdiff_t>(top) * direction.width + static_cast<std::ptrdiff_t>(left);
    live_kernel::Run a = {images_.data() + direction.image + pixel,
                          direction.width,
                          {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy},
                          count,
                          stride};
    for (int c = 0; c < 3; ++c, a.pixels += direction.pixels) kernels.look_up(a, to + c * nx * ny);
  };
  const auto origin = [&](int slice) { return direction.plane.slice_origin(slice).cwiseMax(0.0).eval(); };
  switch (direction.plane.axes()[2]) {
    case 0:  // the plane is (y, z): a run goes along y
      for (int x = 0; x < nx; ++x) run(origin(x) + Vec2d(0, z), ny, nx, out + x);
      break;
    case 1:  // (x, z)
      for (int y = 0; y < ny; ++y) run(origin(y) + Vec2d(0, z), nx, 1, out + y * nx);
      break;
    default: {  // (x, y)
      const Vec2d at = origin(z);
      for (int y = 0; y < ny; ++y) run(at + Vec2d(0, y), nx, 1, out + y * nx);
    }
  }
}

void LiveSums::add(std::span<const float> radiance, LightField& field) {
  const auto& kernels = live_kernel::kernels();
  for (std::size_t d = 0; d < directions_.size(); ++d) {
    const Direction& direction = directions_[d];
    for (std::size_t c = 0; c < 3; ++c)
      kernels.interpolate(direction.weights.data(), direction.pixels, static_cast<int>(probes_),
                          radiance.data() + (3 * d + c) * probes_,
                          images_.data() + direction.image + c * static_cast<std::size_t>(direction.pixels));
  }
  const int count = harmonic_count(degree_);
  const std::size_t values = 3 * field.slab_points(), padded = rounded_up(values),
                    stride = slab_stride(grid_);
  for (int z = 0; z < grid_.size[2]; ++z) {
    std::fill(sums_.begin(), sums_.end(), 0.0f);
    for (std::size_t first = 0; first < directions_.size(); first += kBatch) {
      const std::size_t last = std::min(first + kBatch, directions_.size());
      for (std::size_t d = first; d < last; ++d)
        look_up_slab(directions_[d], z, slab_.data() + (d - first) * stride);
      kernels.project(slab_.data(), static_cast<int>(stride), static_cast<int>(last - first),
                      harmonics_.data() + first * static_cast<std::size_t>(count), count,
                      static_cast<int>(padded), sums_.data());
    }
    for (int h = 0; h < count; ++h) {
      const float* from = sums_.data() + static_cast<std::size_t>(h) * padded;
      float* to = field.plane(z, h, 0);
      for (std::size_t i = 0; i < values; ++i) to[i] += from[i];
    }
  }
}

}  // namespace lightwell
