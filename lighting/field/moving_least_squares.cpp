// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/moving_least_squares.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace lightwell {
namespace {

// Of the squared support: far below the spread of rays all around (a tenth), far above that of a line.
constexpr float kSlopeRidge = 3e-4f;

}  // namespace

LocalFit fit_locally(NearestSamples& samples, const Eigen::Vector2f& at, int support,
                     std::uint32_t left_out) {
  const auto wanted = static_cast<std::size_t>(support) + (left_out == kNoSample ? 0 : 1);
  const auto found = samples.find(at, wanted);
  const std::size_t count = std::min(found.size(), wanted);
  float square_support = 0, nearest = std::numeric_limits<float>::max();
  for (std::size_t i = 0; i < count; ++i)
    if (found[i].sample != left_out) {
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
    if (found[i].sample == left_out) continue;
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

void moving_least_squares(const ShearPlane& plane, NearestSamples& samples, int support, PlaneImage& image) {
  image.resize(plane.width(), plane.height());
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const LocalFit fit = fit_locally(samples, plane.across(Vec2d(x, y)).cast<float>(), support);
      const auto i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x);
      for (int c = 0; c < 3; ++c) image.channel(c)[i] = fit.radiance[c];
      image.channel(3)[i] = static_cast<double>(fit.nearest_cells) <= kNearCells ? 1.0f : 0.0f;
    }
}

}  // namespace lightwell
