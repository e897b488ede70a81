// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/tracker_clock.h"

#include <gtest/gtest.h>

#include <functional>

namespace lightwell {
namespace {

constexpr std::int64_t kMs = 1'000'000;

// Samples each 10 ms for 10 s; what is added to each one's stamp and to its delay of 2 ms.
struct Stream {
  std::vector<std::int64_t> arrivals, samples;
  Stream(const std::function<std::int64_t(int)>& clock_ms, const std::function<std::int64_t(int)>& delay_ms) {
    for (int i = 0; i < 1000; ++i) {
      const std::int64_t now = (1'000'000 + 10 * i) * kMs;
      arrivals.push_back(now + (2 + delay_ms(i)) * kMs);
      samples.push_back(now + clock_ms(i) * kMs);
    }
  }
  [[nodiscard]] std::vector<ClockStep> steps() const { return clock_steps(arrivals, samples); }
};

const auto kNone = [](int) { return std::int64_t{0}; };

TEST(TrackerClock, StepsOfBothKindsAreFoundWhereTheyAre) {
  for (const std::int64_t by_ms : {-3600'000, -1000, -150, 150, 1000, 3600'000}) {
    const Stream stream([&](int i) { return i < 300 ? 0 : by_ms; }, [](int i) { return i * 7 % 5; });
    const auto steps = stream.steps();
    ASSERT_EQ(steps.size(), 1u) << by_ms;
    EXPECT_EQ(steps[0].sample, 300u) << by_ms;
    EXPECT_NEAR(static_cast<double>(steps[0].by_ns) / kMs, static_cast<double>(by_ms), 5) << "its delays";
    const auto times = sample_times(stream.arrivals, stream.samples, steps);
    for (int i = 0; i < 1000; ++i)
      EXPECT_EQ(times[static_cast<std::size_t>(i)], (1'000'000 + 10 * i + 2) * kMs) << by_ms << " " << i;
  }
}

TEST(TrackerClock, WhatANetworkDelaysIsNoStep) {
  const std::function<std::int64_t(int)> delays[] = {
      [](int i) {
        return std::int64_t{i == 999 ? 9 : i == 500 ? 7 : 0};
      },
      // Held up for half a second, then all at once.
      [](int i) { return std::int64_t{i >= 400 && i < 450 ? (450 - i) * 10 - (450 - i) / 10 : 0}; },
      // The end of the take is held up: too short to tell.
      [](int i) { return std::int64_t{i >= 950 ? 200 : 0}; }};
  for (const auto& delay : delays) EXPECT_TRUE(Stream(kNone, delay).steps().empty());
}

}  // namespace
}  // namespace lightwell
