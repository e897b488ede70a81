// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/moving_least_squares.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace lightwell {
namespace {

// Of the squared support: far below the spread of rays all around (a tenth), far above that of a line.
constexpr float kSlopeRidge = 3e-4f;

// To the first `wanted` of what was found about `at`, but for those no farther than left_out_square; one at least is left.
LocalFit fit_beyond(float left_out_square, std::span<const NearestSamples::Neighbour> found,
                    std::size_t wanted, const NearestSamples& samples, const Eigen::Vector2f& at) {
  const std::size_t count = std::min(found.size(), wanted);
  float square_support = 0, nearest = std::numeric_limits<float>::max();
  for (std::size_t i = 0; i < count; ++i)
    if (found[i].square_distance > left_out_square) {
      nearest = std::min(nearest, found[i].square_distance);
      square_support = std::max(square_support, found[i].square_distance);
    }
  // Where there are no more, the farthest keeps a weight.
  square_support = found.size() > wanted ? found[wanted].square_distance : 2 * square_support;
  // Rays in one place have no next one in sight: all count alike.
  square_support = std::max(square_support, 1e-12f);

  float weights = 0;
  Eigen::Vector2f first = Eigen::Vector2f::Zero();
  Eigen::Matrix2f second = Eigen::Matrix2f::Zero();
  Eigen::Array3f sum = Eigen::Array3f::Zero();
  Eigen::Matrix<float, 2, 3> product = Eigen::Matrix<float, 2, 3>::Zero();
  Eigen::Array3f least = Eigen::Array3f::Constant(std::numeric_limits<float>::max()), most = -least;
  for (std::size_t i = 0; i < count; ++i) {
    if (!(found[i].square_distance > left_out_square)) continue;
    const PlaneSample& sample = samples.samples()[found[i].sample];
    const float inside = 1 - found[i].square_distance / square_support;
    const float weight = inside > 0 ? inside * inside : 0;
    const Eigen::Vector2f offset = sample.at - at;
    const Eigen::Vector2f weighted = weight * offset;
    weights += weight;
    first += weighted;
    second += weighted * offset.transpose();
    sum += weight * sample.radiance;
    product += weighted * sample.radiance.matrix().transpose();
    least = least.min(sample.radiance);
    most = most.max(sample.radiance);
  }
  LocalFit fit;
  fit.nearest_cells = std::sqrt(nearest);
  if (!(weights > 0)) {  // every ray found lies at the very end of the support
    fit.radiance = (least + most) / 2;
    return fit;
  }
  const Eigen::Vector2f centroid = first / weights;
  const Eigen::Array3f mean = sum / weights;
  second = second / weights - centroid * centroid.transpose();
  product = product / weights - centroid * mean.matrix().transpose();
  second.diagonal().array() += kSlopeRidge * square_support;
  const Eigen::Matrix<float, 2, 3> slope = second.inverse() * product;
  const Eigen::Array3f beyond = (most - least) / 2;
  fit.radiance =
      (mean - (slope.transpose() * centroid).array()).max(least - beyond).min(most + beyond).max(0.0f);
  return fit;
}

}  // namespace

LocalFit fit_locally(NearestSamples& samples, const Eigen::Vector2f& at, int support) {
  const auto wanted = static_cast<std::size_t>(support);
  return fit_beyond(-1, samples.find(at, wanted), wanted, samples, at);
}

std::optional<LocalFit> foretell(NearestSamples& samples, std::size_t held_out, int support) {
  constexpr float kSquare = kOnePlace_cells * kOnePlace_cells;
  const Eigen::Vector2f at = samples.samples()[held_out].at;
  const auto others = static_cast<std::size_t>(support);
  for (std::size_t wanted = others + 1;;) {
    const auto found = samples.find(at, wanted);
    const std::size_t count = std::min(found.size(), wanted);
    const auto here = static_cast<std::size_t>(
        std::count_if(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count),
                      [](const auto& near) { return near.square_distance <= kSquare; }));
    if (here == samples.samples().size()) return std::nullopt;
    const std::size_t needed = here + others;
    if (needed == wanted || (needed > wanted && count < wanted))
      return fit_beyond(kSquare, found, wanted, samples, at);
    wanted = needed < wanted ? needed : needed + here;  // there may be more in this place
  }
}

namespace {

constexpr float kEverywhere = 1e17f;  // cells
constexpr float kRounding = 1.0001f;  // of a distance
constexpr float kTileSide = 0.8f;     // of the distance to the last ray of a fit
constexpr float kMostTileSide = 16;   // pixels

}  // namespace

// A square of pixels whose rays are searched together: what is near its middle is near all of them.
class MovingLeastSquares::Tile {
 public:
  Tile(const ShearPlane& plane, int x0, int y0, int side)
      : plane_(plane),
        x0_(x0),
        y0_(y0),
        x1_(std::min(x0 + side, plane.width())),
        y1_(std::min(y0 + side, plane.height())),
        middle_(plane.across(Vec2d(x0 + x1_ - 1, y0 + y1_ - 1) / 2).cast<float>()),
        radius_(std::max((at(x0, y0) - middle_).norm(), (at(x1_ - 1, y0) - middle_).norm())) {}

  [[nodiscard]] const Eigen::Vector2f& middle() const { return middle_; }
  [[nodiscard]] float radius() const { return radius_; }  // of its pixels about the middle, cells
  [[nodiscard]] Eigen::Vector2f at(int x, int y) const { return plane_.across(Vec2d(x, y)).cast<float>(); }
  [[nodiscard]] bool is_read(std::span<const std::array<int, 2>> columns) const {
    for (int y = y0_; y < y1_; ++y)
      if (const auto& [begin, end] = columns[static_cast<std::size_t>(y)]; begin < x1_ && x0_ < end)
        return true;
    return false;
  }
  template <class Visit>
  void visit_pixels(const Visit& visit) const {
    for (int y = y0_; y < y1_; ++y)
      for (int x = x0_; x < x1_; ++x)
        visit(static_cast<std::size_t>(y) * static_cast<std::size_t>(plane_.width()) +
                  static_cast<std::size_t>(x),
              at(x, y));
  }

 private:
  const ShearPlane& plane_;
  int x0_, y0_, x1_, y1_;
  Eigen::Vector2f middle_;
  float radius_;
};

float MovingLeastSquares::fit_tile(const Tile& tile, float bound, NearestSamples& samples, int support,
                                   PlaneImage& image) {
  const field_kernel::Kernels& kernels = field_kernel::kernels();
  const float x = tile.middle().x(), y = tile.middle().y();
  field_kernel::Rays rays = around_.rays();
  int somewhere = samples.within(tile.middle(), kRounding * (bound + 2 * tile.radius()), rays);
  int count = around_.pad(somewhere);
  float reach = kEverywhere;
  if (samples.samples().size() > static_cast<std::size_t>(support)) {
    const float guess = bound < kEverywhere ? bound * bound / 2 : 1.0f;
    reach = std::sqrt(
        kernels.square_distance(rays, count, x, y, support, std::max(guess, 1e-12f), squares_.data()));
    // A pixel's own reach is longer by no more than its distance from the middle, and so far away are its rays.
    const float farthest = kRounding * (reach + 2 * tile.radius());
    somewhere = kernels.within(rays, somewhere, x, y, farthest * farthest, near_.rays(), 0);
    count = near_.pad(somewhere);
    rays = near_.rays();
  }
  float guess = std::clamp(reach * reach, 1e-12f, 1e30f);
  tile.visit_pixels([&](std::size_t pixel, const Eigen::Vector2f& at) {
    const field_kernel::Fit fit =
        kernels.fit(rays, count, somewhere, at.x(), at.y(), support, guess, squares_.data());
    guess = fit.square_support;
    Eigen::Array3f radiance(fit.red, fit.green, fit.blue);
    if (!fit.has_weights) radiance = fit_locally(samples, at, support).radiance;
    for (int c = 0; c < 3; ++c) image.channel(c)[pixel] = radiance[c];
    image.channel(3)[pixel] =
        static_cast<double>(fit.square_nearest) <= kNearCells * kNearCells ? 1.0f : 0.0f;
  });
  return reach;
}

void MovingLeastSquares::fit(const ShearPlane& plane, NearestSamples& samples, int support,
                             PlaneImage& image) {
  image.resize(plane.width(), plane.height());
  const std::size_t count = samples.samples().size();
  around_.reserve(count);
  near_.reserve(count);
  squares_.resize(count + field_kernel::kLanes);
  plane.read_columns(columns_);
  const float reach =
      samples.spacing() * std::sqrt(static_cast<float>(support + 1) / static_cast<float>(kPi));
  const int side = static_cast<int>(
      std::clamp(kTileSide * reach * static_cast<float>(plane.pixels_a_cell()), 1.0f, kMostTileSide));
  // What a tile needs is known from its neighbour: nothing moves farther away than one walks.
  float above = kEverywhere;
  Eigen::Vector2f above_middle = Eigen::Vector2f::Zero();
  for (int y = 0; y < plane.height(); y += side) {
    float last = above;
    Eigen::Vector2f last_middle = above_middle;
    bool is_first = true;
    for (int x = 0; x < plane.width(); x += side) {
      const Tile tile(plane, x, y, side);
      if (!tile.is_read(columns_)) continue;
      last = fit_tile(tile, last + (tile.middle() - last_middle).norm(), samples, support, image);
      last_middle = tile.middle();
      if (!std::exchange(is_first, false)) continue;
      above = last;
      above_middle = last_middle;
    }
  }
}

}  // namespace lightwell
