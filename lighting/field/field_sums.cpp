// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/field_sums.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "lighting/field/field_kernel/kernel.h"
#include "lighting/result.h"

namespace lightwell {
namespace {

using field_kernel::kColumn;
using field_kernel::kLanes;
using field_kernel::Pixels;
using field_kernel::Run;

constexpr int kBlockPoints = 512;  // whose values of a batch stay in the cache

// Rows of a slab, from y0 on.
struct Block {
  int y0, rows;
};

// One direction at the points of a block of slab z: [4 channels][stride], points as they lie in the slab.
void look_up(const FieldDirection& direction, const FieldGrid& grid, int z, const Block& block, float* out,
             int stride) {
  const field_kernel::Kernels& kernels = field_kernel::kernels();
  const ShearPlane& plane = direction.plane;
  const int width = direction.image.width, step = plane.pixels_a_cell(), nx = grid.size[0];
  const auto origin = [&](int slice) { return plane.slice_origin(slice).cwiseMax(0.0).eval(); };
  const auto pixels = [&](int channel) { return Pixels{direction.image.channel(channel), width}; };
  if (plane.axes()[2] == 0) {  // the plane is (y, z): a run goes along y
    const auto run_at = [&](int x) {
      const Vec2d at = origin(x);
      return Run{at.x() + block.y0 * step, at.y() + z * step, block.rows, step};
    };
    std::vector<float> run_values(static_cast<std::size_t>(block.rows + kLanes));
    int x = 0;
    if (block.rows == kLanes)
      for (; x + kLanes <= nx; x += kLanes) {
        Run runs[kLanes];
        for (int i = 0; i < kLanes; ++i) runs[i] = run_at(x + i);
        for (int c = 0; c < 4; ++c) kernels.interpolate_across(pixels(c), runs, out + c * stride + x, nx);
      }
    for (; x < nx; ++x) {
      const Run run = run_at(x);
      for (int c = 0; c < 4; ++c) {
        kernels.interpolate(pixels(c), run, run_values.data());
        for (int y = 0; y < block.rows; ++y)
          out[c * stride + y * nx + x] = run_values[static_cast<std::size_t>(y)];
      }
    }
    return;
  }
  const bool across_y = plane.axes()[2] == 1;  // the plane is (x, z), else (x, y)
  Vec2d at = across_y ? Vec2d::Zero() : origin(z);
  for (int y = 0; y < block.rows; ++y) {
    if (across_y) at = origin(block.y0 + y);
    const Run run = {at.x(), at.y() + (across_y ? z : block.y0 + y) * step, nx, step};
    for (int c = 0; c < 4; ++c) kernels.interpolate(pixels(c), run, out + c * stride + y * nx);
  }
}

}  // namespace

FieldSums::FieldSums(const FieldGrid& grid, int degree) : grid_(grid), degree_(degree) {
  verify_bug(degree >= 1 && degree <= kMostFieldDegree, "degree of a field out of range");
  field_.grid = grid;
  field_.degree = degree;
  field_.radiance.assign(grid.points() * 3 * static_cast<std::size_t>(harmonic_count(degree)), 0.0f);
  field_.confidence.assign(grid.points(), 0.0f);
}

FieldSums::FieldSums(LightField sums) : grid_(sums.grid), degree_(sums.degree), field_(std::move(sums)) {}

double FieldSums::bytes_needed(const FieldGrid& grid, int degree) {
  const double points = static_cast<double>(grid.size[0]) * static_cast<double>(grid.size[1]) *
                        static_cast<double>(grid.size[2]);
  return points * (3.0 * harmonic_count(degree) + 1) * sizeof(float);
}

void FieldSums::add(std::span<const FieldDirection> batch, int z) {
  const field_kernel::Kernels& kernels = field_kernel::kernels();
  const int nx = grid_.size[0], ny = grid_.size[1], harmonics = harmonic_count(degree_);
  const auto directions = static_cast<int>(batch.size());
  std::vector<float> weights, known;
  for (const FieldDirection& direction : batch) {
    weights.insert(weights.end(), direction.harmonics.begin(), direction.harmonics.end());
    known.push_back(direction.known_share);
  }
  // Rows by eight, as runs along y come.
  const int most_rows = std::max(kLanes, kBlockPoints / nx / kLanes * kLanes);
  const int columns = (most_rows * nx + kColumn - 1) / kColumn, stride = columns * kColumn + kLanes;
  std::vector<float> row(4 * static_cast<std::size_t>(stride));
  // [channel][column][direction][kColumn]
  const std::ptrdiff_t column_size = static_cast<std::ptrdiff_t>(directions) * kColumn;
  std::vector<float> values(4 * static_cast<std::size_t>(columns * column_size));
  const auto slab = static_cast<long>(field_.slab_points());
  for (int y0 = 0; y0 < ny; y0 += most_rows) {
    const Block block = {y0, std::min(most_rows, ny - y0)};
    const int points = block.rows * nx, used = (points + kColumn - 1) / kColumn;
    for (int d = 0; d < directions; ++d) {
      look_up(batch[static_cast<std::size_t>(d)], grid_, z, block, row.data(), stride);
      for (int c = 0; c < 4; ++c)
        for (int i = 0; i < used; ++i)
          std::copy_n(row.data() + c * stride + i * kColumn, kColumn,
                      values.data() + (c * columns + i) * column_size + d * kColumn);
    }
    for (int i = 0; i < used; ++i) {
      const int first = y0 * nx + i * kColumn, count = std::min(kColumn, points - i * kColumn);
      for (int c = 0; c < 3; ++c)
        kernels.add_products(values.data() + (c * columns + i) * column_size, weights.data(), directions,
                             harmonics, field_.plane(z, 0, c) + first, 3 * slab, count);
      kernels.add_products(values.data() + (3 * columns + i) * column_size, known.data(), directions, 1,
                           field_.confidence.data() + z * slab + first, slab, count);
    }
  }
}

std::span<const float> FieldSums::radiance(int z) const {
  const std::size_t count = field_.slab_points() * 3 * static_cast<std::size_t>(field_.harmonics());
  return std::span(field_.radiance).subspan(static_cast<std::size_t>(z) * count, count);
}

std::span<const float> FieldSums::confidence(int z) const {
  const std::size_t count = field_.slab_points();
  return std::span(field_.confidence).subspan(static_cast<std::size_t>(z) * count, count);
}

void FieldSums::add(std::span<const float> radiance, std::span<const float> confidence, int z) {
  verify_bug(radiance.size() == this->radiance(z).size() && confidence.size() == this->confidence(z).size(),
             "a slab of the same size");
  float* light = field_.radiance.data() + static_cast<std::size_t>(z) * radiance.size();
  for (std::size_t i = 0; i < radiance.size(); ++i) light[i] += radiance[i];
  float* known = field_.confidence.data() + static_cast<std::size_t>(z) * confidence.size();
  for (std::size_t i = 0; i < confidence.size(); ++i) known[i] += confidence[i];
}

void FieldSums::clear() {
  std::fill(field_.radiance.begin(), field_.radiance.end(), 0.0f);
  std::fill(field_.confidence.begin(), field_.confidence.end(), 0.0f);
}

LightField FieldSums::take() && {
  for (float& part : field_.confidence) part = std::clamp(part, 0.0f, 1.0f);  // rounding
  return std::move(field_);
}

}  // namespace lightwell
