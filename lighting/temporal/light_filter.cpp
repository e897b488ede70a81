// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/temporal/light_filter.h"

#include <algorithm>
#include <cmath>

#include "lighting/result.h"
#include "lighting/sampling/light_kernel/kernel.h"
#include "lighting/temporal/minimum_phase.h"

namespace lightwell {
namespace {

constexpr std::array<std::vector<float> LightArrays::*, 3> kPower = {&LightArrays::r, &LightArrays::g,
                                                                     &LightArrays::b};

// To the half frame that symmetric taps have exactly.
double delay_of(std::span<const double> taps) {
  verify_bug(!taps.empty(), "a filter needs a tap");
  const double middle = static_cast<double>(taps.size() - 1) / 2;
  const bool symmetric = std::equal(taps.begin(), taps.end(), taps.rbegin());
  return symmetric ? middle : delay_of_slow_changes(taps);
}

}  // namespace

LightFilter::LightFilter(std::span<const double> taps, std::size_t count, double theta_max_rad)
    : delay_frames_(delay_of(taps)),
      edge_cosine_(std::cos(theta_max_rad)),
      edge_sine_(std::sin(theta_max_rad)),
      history_(taps.size(), LightArrays(count)),
      totals_(taps.size()),
      last_x_(count, 0.0f),
      last_y_(count, 1.0f),
      last_z_(count, 0.0f),
      past_(taps.size()) {
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
  for (std::size_t c = 0; c < 3; ++c) filter_power(c, out.*kPower[c]);
}

void LightFilter::filter_channel(Channel channel, bool within_range, std::vector<float>& out) noexcept {
  for (std::size_t age = 0; age < taps_.size(); ++age) past_[age] = (frame(age).*channel).data();
  const light_kernel::Kernels& kernels = light_kernel::kernels();
  (within_range ? kernels.filter_within_range : kernels.filter)(
      past_.data(), taps_.data(), static_cast<int>(taps_.size()), static_cast<int>(out.size()), out.data());
}

void LightFilter::filter_directions(LightArrays& out) noexcept {
  filter_channel(&LightArrays::x, false, out.x);
  filter_channel(&LightArrays::y, false, out.y);
  filter_channel(&LightArrays::z, false, out.z);
  light_kernel::kernels().settle_directions(out.x.data(), out.y.data(), out.z.data(), last_x_.data(),
                                            last_y_.data(), last_z_.data(), static_cast<int>(out.size()),
                                            static_cast<float>(edge_cosine_), static_cast<float>(edge_sine_));
}

void LightFilter::filter_power(std::size_t c, std::vector<float>& out) noexcept {
  filter_channel(kPower[c], true, out);
  double total = 0;
  double least_total = totals_[newest_][c];
  double largest_total = least_total;
  for (std::size_t age = 0; age < taps_.size(); ++age) {
    const double past_total = totals_[(newest_ + totals_.size() - age) % totals_.size()][c];
    total += static_cast<double>(taps_[age]) * past_total;
    least_total = std::min(least_total, past_total);
    largest_total = std::max(largest_total, past_total);
  }
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
