// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/field_sums.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lighting/result.h"

namespace lightwell {
namespace {

// A run of grid points in the plane: `count` of them, `step` pixels apart from (x, y) on, which all have one fraction of
// a pixel. Written `stride` apart.
struct Run {
  double x, y;
  int count, step, stride;
};

void interpolate_run(const float* pixels, int width, const Run& run, float* out) {
  const double left = std::floor(run.x), top = std::floor(run.y);
  const auto fx = static_cast<float>(run.x - left), fy = static_cast<float>(run.y - top);
  const float w00 = (1 - fx) * (1 - fy), w10 = fx * (1 - fy), w01 = (1 - fx) * fy, w11 = fx * fy;
  const float* upper = pixels + static_cast<std::ptrdiff_t>(top) * width + static_cast<std::ptrdiff_t>(left);
  const float* lower = upper + width;
  if (run.step == 1 && run.stride == 1) {
    for (int i = 0; i < run.count; ++i)
      out[i] = w00 * upper[i] + w10 * upper[i + 1] + w01 * lower[i] + w11 * lower[i + 1];
    return;
  }
  for (int i = 0; i < run.count; ++i, upper += run.step, lower += run.step, out += run.stride)
    *out = w00 * upper[0] + w10 * upper[1] + w01 * lower[0] + w11 * lower[1];
}

// One channel of a direction at all points of slab z.
void look_up(const FieldDirection& direction, const FieldGrid& grid, int channel, int z, float* out) {
  const ShearPlane& plane = direction.plane;
  const float* pixels = direction.image.channel(channel);
  const int width = direction.image.width, step = plane.pixels_a_cell();
  const auto [nx, ny, nz] = grid.size;
  const auto origin = [&](int slice) { return plane.slice_origin(slice).cwiseMax(0.0).eval(); };
  switch (plane.axes()[2]) {
    case 0:  // the plane is (y, z): a run goes along y
      for (int x = 0; x < nx; ++x) {
        const Vec2d at = origin(x);
        interpolate_run(pixels, width, {at.x(), at.y() + z * step, ny, step, nx}, out + x);
      }
      break;
    case 1:  // (x, z)
      for (int y = 0; y < ny; ++y) {
        const Vec2d at = origin(y);
        interpolate_run(pixels, width, {at.x(), at.y() + z * step, nx, step, 1}, out + y * nx);
      }
      break;
    default: {  // (x, y)
      const Vec2d at = origin(z);
      for (int y = 0; y < ny; ++y)
        interpolate_run(pixels, width, {at.x(), at.y() + y * step, nx, step, 1}, out + y * nx);
    }
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
  const auto points = static_cast<Eigen::Index>(field_.slab_points());
  const auto directions = static_cast<Eigen::Index>(batch.size());
  const Eigen::Index count = harmonic_count(degree_);
  Eigen::MatrixXf radiance(3 * points, directions), weights(directions, count);
  Eigen::VectorXf known(points);
  Eigen::Map<Eigen::VectorXf> confidence(field_.confidence.data() + static_cast<Eigen::Index>(z) * points,
                                         points);
  for (Eigen::Index i = 0; i < directions; ++i) {
    const FieldDirection& direction = batch[static_cast<std::size_t>(i)];
    for (int c = 0; c < 3; ++c) look_up(direction, grid_, c, z, radiance.col(i).data() + c * points);
    weights.row(i) = direction.harmonics.transpose();
    look_up(direction, grid_, 3, z, known.data());
    confidence += direction.known_share * known;
  }
  Eigen::Map<Eigen::MatrixXf> sums(field_.plane(z, 0, 0), 3 * points, count);
  sums.noalias() += radiance * weights;
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
