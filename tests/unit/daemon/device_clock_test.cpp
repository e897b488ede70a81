// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/device_clock.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

namespace lightwell {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kPeriod = 16'666'667;

TEST(DeviceClock, RemovesDelayJitterOnceItHasSeenAnUndelayedFrame) {
  DeviceClock clock;
  std::mt19937 random(1);
  std::exponential_distribution<double> delay_ms(1.0);
  for (int i = 0; i < 1000; ++i) {
    const std::int64_t sent = 5'000'000'000 + i * kPeriod;
    const std::int64_t device = sent - 4'000'000'000;
    const std::int64_t delay = i == 0 ? 0 : static_cast<std::int64_t>(delay_ms(random) * 1e6);
    const std::int64_t estimate = clock.undelayed_mono_ns(static_cast<std::uint64_t>(device), sent + delay);
    ASSERT_LE(estimate, sent + delay);
    // The least of the 240 or more delays of the two windows has the mean 1 ms / 240; 1 ms is e^-240 away.
    ASSERT_LT(std::abs(estimate - sent), kMs) << i;
  }
}

TEST(DeviceClock, FollowsDrift) {
  DeviceClock clock;
  for (int i = 0; i < 36'000; ++i) {  // ten minutes at 60 Hz
    const std::int64_t sent = 1'000'000'000 + i * kPeriod;
    const auto device = static_cast<std::uint64_t>(static_cast<double>(sent) * (1 - 50e-6)) + 77;
    const std::int64_t estimate = clock.undelayed_mono_ns(device, sent);
    // 50 ppm over two windows of 2 s: 0.2 ms.
    ASSERT_NEAR(static_cast<double>(estimate - sent), 0, 0.25e6) << i;
  }
}

TEST(DeviceClock, FallsBackToReceptionWithoutAUsableClock) {
  DeviceClock absent;
  for (int i = 1; i < 100; ++i) EXPECT_EQ(absent.undelayed_mono_ns(0, i * kPeriod), i * kPeriod);

  DeviceClock standing;
  for (int i = 1; i < 100; ++i) EXPECT_EQ(standing.undelayed_mono_ns(42, i * kPeriod), i * kPeriod);
}

TEST(DeviceClock, DistrustsAClockOfTheWrongRate) {
  DeviceClock clock;
  std::int64_t estimate = 0, received = 0;
  for (int i = 1; i < 1000; ++i) {
    received = i * kPeriod;
    estimate = clock.undelayed_mono_ns(static_cast<std::uint64_t>(received + received / 10), received);
  }
  EXPECT_EQ(estimate, received);
}

TEST(DeviceClock, StartsAnewAfterAJump) {
  DeviceClock clock;
  const std::int64_t base = 100'000'000'000;
  clock.undelayed_mono_ns(1'000'000'000, base);
  for (int i = 1; i < 10; ++i) {  // the device's clock was set forward by an hour
    const std::int64_t received = base + i * kPeriod;
    const auto device = static_cast<std::uint64_t>(3'601'000'000'000 + i * kPeriod);
    EXPECT_EQ(clock.undelayed_mono_ns(device, received), received);
  }
  const std::int64_t later = base + 20 * kPeriod;  // and back
  EXPECT_EQ(clock.undelayed_mono_ns(2'000'000'000, later), later);
}

}  // namespace
}  // namespace lightwell
