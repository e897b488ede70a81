// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/light_filter.h"

#include <algorithm>
#include <cmath>

#include "lighting/result.h"

namespace lightwell {
namespace {

using Channel = std::vector<float> LightArrays::*;
constexpr std::array<Channel, 3> kPower = {&LightArrays::r, &LightArrays::g, &LightArrays::b};

void add_scaled(const std::vector<float>& in, float weight, std::vector<float>& sum) noexcept {
  const float* __restrict from = in.data();
  float* __restrict to = sum.data();
  const std::size_t count = sum.size();
  for (std::size_t i = 0; i < count; ++i) to[i] += weight * from[i];
}

void widen_range(const std::vector<float>& in, std::vector<float>& least,
                 std::vector<float>& largest) noexcept {
  const float* __restrict from = in.data();
  float* __restrict lo = least.data();
  float* __restrict hi = largest.data();
  const std::size_t count = least.size();
  for (std::size_t i = 0; i < count; ++i) {
    lo[i] = std::min(lo[i], from[i]);
    hi[i] = std::max(hi[i], from[i]);
  }
}

void hold_to_range(const std::vector<float>& least, const std::vector<float>& largest,
                   std::vector<float>& values) noexcept {
  const float* __restrict lo = least.data();
  const float* __restrict hi = largest.data();
  float* __restrict v = values.data();
  const std::size_t count = values.size();
  for (std::size_t i = 0; i < count; ++i) v[i] = std::min(std::max(v[i], lo[i]), hi[i]);
}

}  // namespace

LightFilter::LightFilter(std::span<const double> taps, std::size_t count, double theta_max_rad)
    : edge_cosine_(std::cos(theta_max_rad)),
      edge_sine_(std::sin(theta_max_rad)),
      history_(taps.size(), LightArrays(count)),
      totals_(taps.size()),
      last_x_(count, 0.0f),
      last_y_(count, 1.0f),
      last_z_(count, 0.0f),
      least_(count),
      largest_(count) {
  verify_bug(!taps.empty(), "a filter needs a tap");
  for (const double t : taps) taps_.push_back(static_cast<float>(t));
  if (std::abs(edge_cosine_) < 1e-15)
    edge_cosine_ = 0;  // the horizon is at 0, not at cos(π/2) in floating point
}

void LightFilter::reset() noexcept {
  filled_ = false;
}

void LightFilter::apply(const LightArrays& in, LightArrays& out) noexcept {
  verify_bug(in.size() == last_x_.size() && out.size() == in.size(),
             "the filter was made for another count of lights");
  const std::array<double, 3> total = {sum_of(in.r), sum_of(in.g), sum_of(in.b)};
  if (!filled_) {
    for (LightArrays& past : history_) past = in;  // same sizes: copies, allocates nothing
    std::fill(totals_.begin(), totals_.end(), total);
    last_x_ = in.x;
    last_y_ = in.y;
    last_z_ = in.z;
    filled_ = true;
  }
  newest_ = (newest_ + 1) % history_.size();
  history_[newest_] = in;
  totals_[newest_] = total;
  filter_directions(out);
  for (int c = 0; c < 3; ++c) filter_power(c, out.*kPower[static_cast<std::size_t>(c)]);
}

void LightFilter::filter_directions(LightArrays& out) noexcept {
  std::fill(out.x.begin(), out.x.end(), 0.0f);
  std::fill(out.y.begin(), out.y.end(), 0.0f);
  std::fill(out.z.begin(), out.z.end(), 0.0f);
  for (std::size_t age = 0; age < taps_.size(); ++age) {
    add_scaled(frame(age).x, taps_[age], out.x);
    add_scaled(frame(age).y, taps_[age], out.y);
    add_scaled(frame(age).z, taps_[age], out.z);
  }
  const auto edge_cosine = static_cast<float>(edge_cosine_);
  const auto edge_sine = static_cast<float>(edge_sine_);
  float* __restrict x = out.x.data();
  float* __restrict y = out.y.data();
  float* __restrict z = out.z.data();
  float* __restrict last_x = last_x_.data();
  float* __restrict last_y = last_y_.data();
  float* __restrict last_z = last_z_.data();
  const std::size_t count = out.size();
  constexpr float kShortest = 0.05f;
  for (std::size_t i = 0; i < count; ++i) {
    const float length = std::sqrt(x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
    const float scale = 1 / std::max(length, kShortest);
    const float horizontal = std::sqrt(x[i] * x[i] + z[i] * z[i]);
    const bool below = y[i] * scale < edge_cosine;
    // Straight down there is no azimuth to keep. (No short circuits: the loop is to become vectors.)
    const bool keep = (length < kShortest) | (below & (horizontal < 1e-6f));
    const float flat_scale = below ? edge_sine / std::max(horizontal, 1e-6f) : scale;
    const float nx = x[i] * flat_scale;
    const float ny = below ? edge_cosine : y[i] * scale;
    const float nz = z[i] * flat_scale;
    const float kx = last_x[i], ky = last_y[i], kz = last_z[i];
    last_x[i] = x[i] = keep ? kx : nx;
    last_y[i] = y[i] = keep ? ky : ny;
    last_z[i] = z[i] = keep ? kz : nz;
  }
}

void LightFilter::filter_power(int channel, std::vector<float>& out) noexcept {
  const auto c = static_cast<std::size_t>(channel);
  std::fill(out.begin(), out.end(), 0.0f);
  least_ = frame(0).*kPower[c];
  largest_ = least_;
  double total = 0;
  double least_total = totals_[newest_][c];
  double largest_total = least_total;
  for (std::size_t age = 0; age < taps_.size(); ++age) {
    const std::vector<float>& past = frame(age).*kPower[c];
    add_scaled(past, taps_[age], out);
    widen_range(past, least_, largest_);
    const double past_total = totals_[(newest_ + totals_.size() - age) % totals_.size()][c];
    total += static_cast<double>(taps_[age]) * past_total;
    least_total = std::min(least_total, past_total);
    largest_total = std::max(largest_total, past_total);
  }
  hold_to_range(least_, largest_, out);
  total = std::clamp(total, least_total, largest_total);
  const double sum = sum_of(out);
  if (sum > 0) {
    const auto scale = static_cast<float>(total / sum);
    for (float& v : out) v *= scale;
  } else if (total > 0) {
    const auto share = static_cast<float>(total / static_cast<double>(out.size()));
    std::fill(out.begin(), out.end(), share);
  }
}

}  // namespace lightwell
