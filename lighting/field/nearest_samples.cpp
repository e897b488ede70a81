// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/nearest_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lighting/result.h"

namespace lightwell {
namespace {

constexpr float kSamplesABin = 2;

}  // namespace

float NearestSamples::spacing() const {
  return width_ / std::sqrt(kSamplesABin);
}

int NearestSamples::bin_along(int axis, float value) const {
  const float bin = (value - low_[axis]) / width_;
  return static_cast<int>(
      std::clamp(bin, 0.0f, static_cast<float>(size_[static_cast<std::size_t>(axis)] - 1)));
}

void NearestSamples::build(std::span<const PlaneSample> samples) {
  verify_bug(!samples.empty(), "nearest of no samples");
  samples_ = samples;
  Eigen::Vector2f high = samples.front().at;
  low_ = high;
  for (const PlaneSample& sample : samples) {
    low_ = low_.cwiseMin(sample.at);
    high = high.cwiseMax(sample.at);
  }
  const Eigen::Vector2f extent = high - low_;
  const auto count = static_cast<float>(samples.size());
  width_ = std::max(  // the second where they lie on a line
      {std::sqrt(extent.prod() * kSamplesABin / count), extent.maxCoeff() * kSamplesABin / count, 1e-6f});
  for (int i = 0; i < 2; ++i) size_[static_cast<std::size_t>(i)] = 1 + static_cast<int>(extent[i] / width_);
  first_.assign(static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) + 1, 0);
  bin_.resize(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const int bin = bin_along(1, samples[i].at.y()) * size_[0] + bin_along(0, samples[i].at.x());
    bin_[i] = static_cast<std::uint32_t>(bin);
    ++first_[bin_[i] + 1];
  }
  for (std::size_t b = 1; b < first_.size(); ++b) first_[b] += first_[b - 1];
  order_.resize(samples.size());
  sorted_.reserve(samples.size());
  const field_kernel::Rays sorted = sorted_.rays();
  for (std::size_t i = samples.size(); i-- > 0;) {  // from behind: each bin's end moves down to its beginning
    const std::uint32_t slot = --first_[bin_[i] + 1];
    order_[slot] = static_cast<std::uint32_t>(i);
    sorted.x[slot] = samples[i].at.x();
    sorted.y[slot] = samples[i].at.y();
    sorted.red[slot] = samples[i].radiance[0];
    sorted.green[slot] = samples[i].radiance[1];
    sorted.blue[slot] = samples[i].radiance[2];
  }
  // Each entry has become the beginning of the bin before it.
  first_.erase(first_.begin());
  first_.push_back(static_cast<std::uint32_t>(samples.size()));
}

void NearestSamples::gather(int x0, int x1, int y, const Eigen::Vector2f& at) {
  if (y < 0 || y >= size_[1]) return;
  x0 = std::max(x0, 0);
  x1 = std::min(x1, size_[0] - 1);
  if (x0 > x1) return;
  const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(size_[0]);
  const field_kernel::Rays sorted = sorted_.rays();
  for (std::uint32_t i = first_[row + static_cast<std::size_t>(x0)];
       i < first_[row + static_cast<std::size_t>(x1) + 1]; ++i) {
    const Eigen::Vector2f offset(sorted.x[i] - at.x(), sorted.y[i] - at.y());
    found_.push_back({offset.squaredNorm(), order_[i]});
  }
}

int NearestSamples::within(const Eigen::Vector2f& at, float distance, const field_kernel::Rays& to) {
  const int x0 = bin_along(0, at.x() - distance), x1 = bin_along(0, at.x() + distance);
  const int y0 = bin_along(1, at.y() - distance), y1 = bin_along(1, at.y() + distance);
  int count = 0;
  for (int y = y0; y <= y1; ++y) {  // the bins of a row lie one after the other
    const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(size_[0]);
    const std::uint32_t first = first_[row + static_cast<std::size_t>(x0)];
    const std::uint32_t end = first_[row + static_cast<std::size_t>(x1) + 1];
    count = field_kernel::kernels().within(sorted_.rays_from(first), static_cast<int>(end - first), at.x(),
                                           at.y(), distance * distance, to, count);
  }
  return count;
}

std::span<const NearestSamples::Neighbour> NearestSamples::find(const Eigen::Vector2f& at,
                                                                std::size_t count) {
  const auto nearer = [](const Neighbour& a, const Neighbour& b) {
    return a.square_distance != b.square_distance ? a.square_distance < b.square_distance
                                                  : a.sample < b.sample;
  };
  found_.clear();
  const int x = bin_along(0, at.x()), y = bin_along(1, at.y());
  constexpr float kEnd = std::numeric_limits<float>::max();
  for (int ring = 0;; ++ring) {
    gather(x - ring, x + ring, y - ring, at);
    if (ring > 0) gather(x - ring, x + ring, y + ring, at);
    for (int row = y - ring + 1; row < y + ring; ++row) {
      gather(x - ring, x - ring, row, at);
      gather(x + ring, x + ring, row, at);
    }
    // Nothing nearer than the nearest open side of the block can be missing.
    const float left = x - ring <= 0 ? kEnd : at.x() - (low_.x() + static_cast<float>(x - ring) * width_);
    const float right =
        x + ring >= size_[0] - 1 ? kEnd : low_.x() + static_cast<float>(x + ring + 1) * width_ - at.x();
    const float above = y - ring <= 0 ? kEnd : at.y() - (low_.y() + static_cast<float>(y - ring) * width_);
    const float below =
        y + ring >= size_[1] - 1 ? kEnd : low_.y() + static_cast<float>(y + ring + 1) * width_ - at.y();
    const float sure = std::min({left, right, above, below});
    if (sure == kEnd) break;
    if (found_.size() <= count || sure < 0) continue;
    std::nth_element(found_.begin(), found_.begin() + static_cast<std::ptrdiff_t>(count), found_.end(),
                     nearer);
    if (found_[count].square_distance <= sure * sure) return found_;
  }
  if (found_.size() > count)
    std::nth_element(found_.begin(), found_.begin() + static_cast<std::ptrdiff_t>(count), found_.end(),
                     nearer);
  return found_;
}

}  // namespace lightwell
