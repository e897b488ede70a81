// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/strobe.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <vector>

#include "firmware/core/board_time.h"

namespace {

constexpr std::uint64_t kHz = 84'000'000;
constexpr std::uint64_t kPeriod = kHz / 60;
constexpr std::uint64_t kBounce = kHz / 20'000;  // 50 µs
constexpr std::uint64_t kWindow = kHz / 100;     // 10 ms

strobe fresh(std::uint64_t window = kWindow) {
  strobe self{};
  strobe_init(&self, window, kPeriod, kBounce);
  return self;
}

TEST(Strobe, PairsRiseAndFallAndSaysWhatIsMissing) {
  strobe self = fresh();
  strobe_report report{};
  strobe_trigger(&self, 7, 1000);
  EXPECT_FALSE(strobe_edge(&self, 1500, true, &report));
  EXPECT_FALSE(strobe_edge(&self, 90'000, false, &report));
  EXPECT_FALSE(strobe_poll(&self, 90'000 + kBounce, &report));
  ASSERT_TRUE(strobe_poll(&self, 90'001 + kBounce, &report));
  EXPECT_TRUE(report.paired);
  EXPECT_EQ(report.n, 7u);
  EXPECT_EQ(report.rise, 1500u);
  EXPECT_EQ(report.fall, 90'000u);
  EXPECT_FALSE(report.no_fall || report.bounced);

  strobe_trigger(&self, 8, 1000 + kPeriod);
  EXPECT_FALSE(strobe_edge(&self, 1600 + kPeriod, true, &report));  // its fall never comes
  EXPECT_FALSE(strobe_poll(&self, 1600 + 2 * kPeriod, &report));
  ASSERT_TRUE(strobe_poll(&self, 1601 + 2 * kPeriod, &report));
  EXPECT_TRUE(report.no_fall);
  EXPECT_EQ(report.fall, 0u);
}

TEST(Strobe, AStrobeWithoutATriggerInItsWindowIsAStray) {
  strobe self = fresh();
  strobe_report report{};
  EXPECT_FALSE(strobe_edge(&self, 500, true, &report));  // before any trigger
  EXPECT_FALSE(strobe_edge(&self, 600, false, &report));
  ASSERT_TRUE(strobe_poll(&self, kPeriod, &report));
  EXPECT_FALSE(report.paired);
  strobe_trigger(&self, 0, kPeriod);
  EXPECT_FALSE(strobe_edge(&self, kPeriod + kWindow + 1, true, &report));
  EXPECT_EQ(self.stray, 2u);
  EXPECT_EQ(self.paired, 0u);
}

TEST(Strobe, TheWindowNeverReachesIntoTheNextPeriod) {
  strobe self = fresh(10 * kPeriod);
  EXPECT_LT(self.window, kPeriod);
}

TEST(Strobe, AFallBehindTheNextTriggerStillEndsItsOwnExposure) {
  strobe self = fresh();
  strobe_report report{};
  strobe_trigger(&self, 1, 1000);
  strobe_edge(&self, 200'000, true, &report);
  strobe_trigger(&self, 2, 1000 + kPeriod);
  EXPECT_FALSE(strobe_edge(&self, 1000 + kPeriod + 100'000, false, &report));
  ASSERT_TRUE(strobe_edge(&self, 200'000 + kPeriod, true, &report));  // the next rise ends it
  EXPECT_EQ(report.n, 1u);
  EXPECT_EQ(report.fall, 1000 + kPeriod + 100'000);
}

// Ten hours at 60 Hz through a counter of 32 bits: triggers that the camera misses, strobes and single edges that get
// lost, edges that bounce, delays and exposures that vary. What is reported is held against what happened.
TEST(Strobe, NoWrongPairInAMillionFrames) {
  std::mt19937_64 random(1);
  const auto one_in_20 = [&] { return random() % 20 == 0; };
  strobe self = fresh();
  board_time time;
  const std::uint64_t start = 0xFFFFFF00u;  // the counter's first wrap is at once
  board_time_init(&time, static_cast<std::uint32_t>(start));
  struct Truth {
    std::uint64_t rise = 0, fall = 0;
  };
  std::map<std::uint32_t, Truth> truth;
  struct Edge {
    std::uint64_t tick;
    bool rise;
  };
  std::vector<Edge> edges;  // in order; those not yet delivered
  strobe_report report{};
  std::uint64_t wrong = 0, whole = 0, expected = 0, no_fall = 0;
  const auto check = [&] {
    if (!report.paired) return;
    const auto found = truth.find(report.n);
    const bool rise_right = found != truth.end() && report.rise == found->second.rise;
    const bool fall_right =
        report.no_fall ? report.fall == 0 : rise_right && report.fall == found->second.fall;
    if (!rise_right || !fall_right) ++wrong;
    if (rise_right && fall_right && !report.no_fall) ++whole;
    if (report.no_fall) ++no_fall;
  };
  const auto deliver = [&](std::uint64_t until) {
    std::size_t i = 0;
    for (; i < edges.size() && edges[i].tick < until; ++i) {
      if (strobe_poll(&self, edges[i].tick, &report)) check();
      const std::uint64_t tick = board_time_of(&time, static_cast<std::uint32_t>(edges[i].tick));
      board_time_update(&time, static_cast<std::uint32_t>(edges[i].tick));
      if (strobe_edge(&self, tick, edges[i].rise, &report)) check();
    }
    edges.erase(edges.begin(), edges.begin() + static_cast<std::ptrdiff_t>(i));
  };

  for (std::uint32_t frame = 0; frame < 1'000'000; ++frame) {
    const std::uint64_t tick = start + std::uint64_t{frame} * kPeriod;
    deliver(tick);
    const auto n = static_cast<std::uint32_t>(0xFFFFFF00u + frame);  // the number wraps too
    strobe_trigger(&self, n, board_time_update(&time, static_cast<std::uint32_t>(tick)));
    truth.erase(n - 8);
    if (one_in_20()) continue;  // the camera missed it
    const std::uint64_t rise = tick + 1000 + random() % (kWindow - 2000);
    const std::uint64_t fall = rise + kBounce * 3 + random() % (kPeriod - kWindow - kBounce * 8);
    if (one_in_20()) continue;  // the strobe line is lost
    const bool rise_lost = random() % 100 == 0, fall_lost = random() % 100 == 0;
    truth[n] = {rise, fall};
    if (!rise_lost) {
      edges.push_back({rise, true});
      if (one_in_20()) {  // bounces
        edges.push_back({rise + kBounce / 4, false});
        edges.push_back({rise + kBounce / 2, true});
      } else if (one_in_20()) {  // a rise seen twice
        edges.push_back({rise + kBounce / 3, true});
      }
    }
    if (!fall_lost) {
      if (one_in_20() && !rise_lost) {
        edges.push_back({fall - kBounce / 2, false});
        edges.push_back({fall - kBounce / 4, true});
      }
      edges.push_back({fall, false});
    }
    expected += !rise_lost && !fall_lost;
  }
  deliver(start + 2'000'000ull * kPeriod);
  if (strobe_poll(&self, start + 3'000'000ull * kPeriod, &report)) check();
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(whole, expected);  // and none that could be known is thrown away
  EXPECT_GT(no_fall, 5000u);   // 1 % of falls are lost
  EXPECT_GT(self.unanswered, 90'000u);
}

}  // namespace
