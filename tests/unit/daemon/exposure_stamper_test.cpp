// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/exposure_stamper.h"

#include <gtest/gtest.h>

#include <atomic>
#include <random>
#include <thread>

namespace lightwell {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kPeriod = 16 * kMs;

StrobedExposure exposure(std::uint32_t trigger) {
  const std::int64_t begin = 1000 * kMs + trigger * kPeriod;
  return {trigger, begin, begin + 8 * kMs};
}

// Frame of a trigger, whole in memory 5 ms after its exposure; its camera stamps it badly.
FrameInfo frame(std::uint32_t trigger, std::uint64_t sequence) {
  FrameInfo info;
  info.sequence = sequence;
  info.received_mono_ns = exposure(trigger).end_mono_ns + 5 * kMs;
  info.capture_mono_ns = info.received_mono_ns - 2 * kMs;
  info.capture_utc_ns = info.capture_mono_ns + 77;
  return info;
}

// Frames until the stamper trusts a lead.
constexpr std::uint32_t kUntil = ExposureStamper::kLater + ExposureStamper::kAgreeing;

TEST(ExposureStamper, AFrameTakesTheMiddleOfItsExposure) {
  StrobeRing strobes;
  ExposureStamper stamper(strobes);
  for (std::uint32_t n = 0; n < 300; ++n) {
    strobes.push(exposure(n));
    FrameInfo info = frame(n, n + 40);
    ASSERT_EQ(stamper.stamp(info), n + 1 >= kUntil) << n;
    if (n + 1 >= kUntil) {
      EXPECT_EQ(info.capture_mono_ns, exposure(n).middle_mono_ns());
    }
    EXPECT_EQ(info.capture_utc_ns, info.capture_mono_ns + 77);
  }
  EXPECT_EQ(stamper.stamped(), 301 - kUntil);
}

TEST(ExposureStamper, WhereItIsNotUsedFramesStayAsTheyAre) {
  StrobeRing strobes;
  ExposureStamper stamper(strobes);
  stamper.use(false);
  for (std::uint32_t n = 0; n < 50; ++n) {
    strobes.push(exposure(n));
    FrameInfo info = frame(n, n);
    const std::int64_t before = info.capture_mono_ns;
    EXPECT_FALSE(stamper.stamp(info));
    EXPECT_EQ(info.capture_mono_ns, before);
  }
  EXPECT_EQ(stamper.left(), 0u);
}

TEST(ExposureStamper, WithoutAStrobeAFrameStaysAsItIs) {
  StrobeRing strobes;
  ExposureStamper stamper(strobes);
  for (std::uint32_t n = 0; n < 100; ++n) {
    FrameInfo info = frame(n, n);
    const std::int64_t before = info.capture_mono_ns;
    EXPECT_FALSE(stamper.stamp(info));
    EXPECT_EQ(info.capture_mono_ns, before);
  }
  EXPECT_EQ(stamper.left(), 0u) << "no board, nothing missed";
}

// One in twenty strobes and frames is lost: a frame is stamped right or not at all.
TEST(ExposureStamper, LossesMakeNoWrongPair) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    std::mt19937 random(seed);
    StrobeRing strobes;
    ExposureStamper stamper(strobes);
    int stamped = 0, frames = 0;
    for (std::uint32_t n = 0; n < 200000; ++n) {
      if (random() % 20 != 0) strobes.push(exposure(n));
      if (random() % 20 == 0) continue;
      FrameInfo info = frame(n, n);
      ++frames;
      if (!stamper.stamp(info)) continue;
      ++stamped;
      ASSERT_EQ(info.capture_mono_ns, exposure(n).middle_mono_ns()) << n;
    }
    EXPECT_GT(stamped, frames * 94 / 100) << "all but those whose own strobe was lost";
  }
}

// What the board says arrives three frames after the frame that it is about.
TEST(ExposureStamper, LateStrobesStampNothingRatherThanTheFrameBefore) {
  StrobeRing strobes;
  ExposureStamper stamper(strobes);
  for (std::uint32_t n = 3; n < 200; ++n) {
    strobes.push(exposure(n - 3));
    FrameInfo info = frame(n, n);
    EXPECT_FALSE(stamper.stamp(info));
  }
  EXPECT_GT(stamper.left(), 0u);
}

TEST(ExposureStamper, ACameraThatMissedATriggerIsFollowedOnceSeveralFramesAgree) {
  StrobeRing strobes;
  ExposureStamper stamper(strobes);
  for (std::uint32_t n = 0; n < 200; ++n) {
    if (n == 100) continue;  // the trigger came, the camera did not expose and did not count
    strobes.push(exposure(n));
    FrameInfo info = frame(n, n < 100 ? n : n - 1);
    if (!stamper.stamp(info)) continue;
    EXPECT_EQ(info.capture_mono_ns, exposure(n).middle_mono_ns()) << n;
  }
  EXPECT_GE(stamper.stamped(), 200 - 2 * kUntil);
}

TEST(ExposureStamper, TriggersMayWrap) {
  StrobeRing strobes;
  ExposureStamper stamper(strobes);
  for (std::uint32_t i = 0; i < 60; ++i) {
    StrobedExposure e = exposure(i);
    e.trigger = 0xfffffff6u + i;
    strobes.push(e);
    FrameInfo info = frame(i, i);
    EXPECT_EQ(stamper.stamp(info), i + 1 >= kUntil);
  }
}

// The frame path reads while the board's thread writes: what it gets is one exposure, not parts of two.
TEST(StrobeRing, ReadersGetWholeExposures) {
  StrobeRing strobes;
  std::atomic<bool> over{false};
  std::uint32_t last = 0;
  std::thread writer([&] {
    for (std::uint32_t n = 1; !over; ++n) {
      strobes.push({n, n * 1000L, n * 1000L + 7});
      last = n;
    }
  });
  for (int seen = 0; seen < 20000;) {
    const auto e = strobes.newest_before(1L << 60);
    if (!e) continue;
    ++seen;
    if (e->begin_mono_ns != e->trigger * 1000L || e->end_mono_ns != e->begin_mono_ns + 7) {
      ADD_FAILURE() << e->trigger << " " << e->begin_mono_ns << " " << e->end_mono_ns;
      break;
    }
  }
  over = true;
  writer.join();
  EXPECT_EQ(strobes.newest_before(1L << 60)->trigger, last);
  EXPECT_EQ(strobes.find(last - 5)->begin_mono_ns, (last - 5) * 1000L);
  EXPECT_FALSE(strobes.find(last - 64));
  EXPECT_FALSE(strobes.newest_before(1000)) << "older than the ring goes back";
}

}  // namespace
}  // namespace lightwell
