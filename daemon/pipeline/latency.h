// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace lightwell {

// The last kSize durations of one step, written by one thread, read by any. add allocates nothing and never
// waits.
class LatencyWindow {
 public:
  static constexpr std::size_t kSize = 1000;

  void add(double ms) noexcept {
    const std::size_t n = count_.load(std::memory_order_relaxed);
    values_[n % kSize].store(static_cast<float>(ms), std::memory_order_relaxed);
    count_.store(n + 1, std::memory_order_release);
  }

  struct Quantiles {
    double p50 = std::numeric_limits<double>::quiet_NaN();
    double p99 = std::numeric_limits<double>::quiet_NaN();
  };
  // Nearest-rank quantiles; NaN before the first value.
  [[nodiscard]] Quantiles quantiles() const {
    const std::size_t n = std::min(count_.load(std::memory_order_acquire), kSize);
    if (n == 0) return {};
    std::vector<float> sorted(n);
    for (std::size_t i = 0; i < n; ++i) sorted[i] = values_[i].load(std::memory_order_relaxed);
    std::sort(sorted.begin(), sorted.end());
    const auto rank = [&](double q) {
      return sorted[static_cast<std::size_t>(std::ceil(q * static_cast<double>(n))) - 1];
    };
    return {rank(0.50), rank(0.99)};
  }

 private:
  std::array<std::atomic<float>, kSize> values_{};
  std::atomic<std::size_t> count_{0};
};

}  // namespace lightwell
