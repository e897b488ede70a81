// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/board_clock_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace lightwell {
namespace {

using Delay = std::function<double(std::mt19937&)>;  // nanoseconds, one way

// Two clocks, the board's fast by some ppm, and 40 exchanges a second between them.
class Clocks {
 public:
  Clocks(double drift_ppm, Delay delay, unsigned seed)
      : rate_(1 + drift_ppm * 1e-6), delay_(std::move(delay)), random_(seed) {}

  [[nodiscard]] std::int64_t board_ns(double mono_ns) const {
    return std::llround((mono_ns - epoch_ns_) * rate_ + 5e9);
  }
  ClockExchange exchange(double mono_ns) {
    const double received = mono_ns + kWire + delay_(random_);
    const double answered = received + 20e3;
    const double returned = answered + kWire + delay_(random_);
    return {std::llround(mono_ns), board_ns(received), board_ns(answered), std::llround(returned)};
  }
  // Feeds a map; the squared error of what is asked at each answer, after begin_s. Microseconds rms.
  double run(BoardClockMap& map, double from_s, double to_s, double begin_s) {
    double squares = 0;
    int count = 0;
    for (double t = from_s * 1e9; t < to_s * 1e9; t += 25e6) {
      const ClockExchange e = exchange(t);
      EXPECT_TRUE(map.add(e));
      if (t < begin_s * 1e9) continue;
      const double truth = t + 10e6;  // a strobe a little later
      squares += std::pow((static_cast<double>(*map.mono_ns(board_ns(truth))) - truth) * 1e-3, 2);
      ++count;
    }
    return std::sqrt(squares / std::max(count, 1));
  }
  void start_anew(double mono_ns) { epoch_ns_ = mono_ns; }

 private:
  static constexpr double kWire = 60e3;
  double rate_;
  Delay delay_;
  std::mt19937 random_;
  double epoch_ns_ = 0;
};

double uniform_ms(std::mt19937& random) {
  return std::uniform_real_distribution<double>(0, 1e6)(random);
}
double exponential_ms(std::mt19937& random) {
  return std::exponential_distribution<double>(1e-6)(random);
}
// Half-normal, and one in fifty is held up for 20 ms.
double held_up(std::mt19937& random) {
  return random() % 50 == 0 ? 20e6 : std::abs(std::normal_distribution<double>(0, 1e6)(random));
}

TEST(BoardClockMap, MapsToFiftyMicrosecondsThroughAMillisecondOfNoise) {
  for (const Delay& delay : {Delay(uniform_ms), Delay(exponential_ms), Delay(held_up)})
    for (const double drift : {-80.0, 0.0, 37.0})
      for (unsigned seed = 0; seed < 4; ++seed) {
        Clocks clocks(drift, delay, seed);
        BoardClockMap map;
        EXPECT_LE(clocks.run(map, 1, 61, 5), 50) << drift;
        EXPECT_NEAR(map.drift_ppm(), drift, 0.1);
        EXPECT_LT(map.bound_us(), 200) << "twice the wire's delay and a rest of the noise";
      }
}

TEST(BoardClockMap, IsNeverFurtherOffThanItsBound) {
  Clocks clocks(20, held_up, 3);
  BoardClockMap map;
  for (double t = 1e9; t < 30e9; t += 25e6) {
    const ClockExchange e = clocks.exchange(t);
    map.add(e);
    const double off_us = std::abs(static_cast<double>(*map.mono_ns(e.received_board_ns)) -
                                   (static_cast<double>(e.received_board_ns) - 5e9) / (1 + 20e-6)) *
                          1e-3;
    EXPECT_LE(off_us, map.bound_us() + 5) << t;  // 5: what the newest exchanges, not yet fitted, add by drift
  }
}

TEST(BoardClockMap, ABoardThatStartsAnewIsANewMap) {
  Clocks clocks(-15, exponential_ms, 1);
  BoardClockMap map;
  clocks.run(map, 100, 110, 200);
  clocks.start_anew(110e9);
  EXPECT_LE(clocks.run(map, 110.1, 130, 112), 60);
  EXPECT_NEAR(map.drift_ppm(), -15, 1);
}

TEST(BoardClockMap, ACrystalThatJumpsIsFollowed) {
  Clocks before(10, uniform_ms, 1), after(60, uniform_ms, 2);
  BoardClockMap map;
  before.run(map, 1, 31, 100);
  after.run(map, 31, 61, 100);  // 50 ppm for 31 s are 1.5 ms at once, and then another rate
  EXPECT_LE(after.run(map, 61, 100, 61), 50);
}

TEST(BoardClockMap, RefusesTimesOutOfOrderAndKnowsNothingAtFirst) {
  BoardClockMap map;
  EXPECT_FALSE(map.mono_ns(5));
  EXPECT_TRUE(std::isinf(map.bound_us()));
  EXPECT_FALSE(map.add({1000, 0, 0, 900}));
  EXPECT_FALSE(map.add({1000, 10, 5, 1100}));
  EXPECT_FALSE(map.add({1000, 0, 500, 1100})) << "longer on the board than there and back";
  EXPECT_EQ(map.exchanges(), 0u);
  EXPECT_TRUE(map.add({1000, 0, 50, 1100}));
  EXPECT_NEAR(static_cast<double>(*map.mono_ns(25)), 1050, 26);
}

}  // namespace
}  // namespace lightwell
