// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/ptp_clock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lightwell {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr std::int64_t kUtc = 1'700'000'000'000'000'000, kLeap = 37'000'000'000, kMs = 1'000'000;

// A frame every 10 ms for 30 s, stamped in TAI plus this error; the quickest takes 3 ms, others up to 9 ms longer.
PtpClock after_frames(std::int64_t error_ns, std::int64_t epoch_ns = kLeap) {
  PtpClock clock;
  for (std::int64_t i = 0; i < 3000; ++i) {
    const std::int64_t utc = kUtc + i * 10 * kMs;
    const std::int64_t delay = (3 + i * 7 % 10) * kMs;
    clock.saw(static_cast<std::uint64_t>(utc + epoch_ns + error_ns - delay), utc + kLeap, utc);
  }
  return clock;
}

TEST(PtpClock, SaysNothingWherePtpIsOff) {
  EXPECT_EQ(after_frames(0).words("", true), "");
}

TEST(PtpClock, ClocksThatAgreeAreInStepToTheQuickestFramesDelay) {
  EXPECT_EQ(after_frames(0).words("Slave", true), "PTP Slave, in step with this machine's clock to 4 ms");
  EXPECT_EQ(after_frames(0).words("Master", true), "PTP Master, in step with this machine's clock to 4 ms");
  // A domain that counts UTC is as good.
  EXPECT_THAT(after_frames(0, 0).words("Slave", true), HasSubstr("in step"));
}

TEST(PtpClock, ClocksThatDifferSayByHowMuch) {
  EXPECT_EQ(after_frames(-5'000 * kMs).words("Slave", true), "PTP Slave, 5 s behind this machine's clock");
  EXPECT_EQ(after_frames(+5'000 * kMs).words("Slave", true), "PTP Slave, 5 s ahead of this machine's clock");
}

TEST(PtpClock, NothingIsClaimedWhereNobodyKeepsAClock) {
  EXPECT_THAT(after_frames(0).words("Slave", false), HasSubstr("kept by nothing"));
  EXPECT_EQ(after_frames(0).words("Listening", true), "PTP Listening");
  EXPECT_THAT(PtpClock().words("Slave", true), Not(HasSubstr("in step")));
}

TEST(PtpClock, ClockThatStepsIsNoticed) {
  PtpClock clock = after_frames(0);
  for (std::int64_t i = 3000; i < 6000; ++i) {
    const std::int64_t utc = kUtc + i * 10 * kMs;
    clock.saw(static_cast<std::uint64_t>(utc + kLeap - 20'000 * kMs), utc + kLeap, utc);
  }
  EXPECT_EQ(clock.words("Slave", true), "PTP Slave, 17 s ahead of this machine's clock")
      << "nearer to UTC now";
}

}  // namespace
}  // namespace lightwell
