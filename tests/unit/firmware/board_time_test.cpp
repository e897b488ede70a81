// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/board_time.h"

#include <gtest/gtest.h>

#include <random>

namespace {

TEST(BoardTime, GoesOnAcrossWraps) {
  board_time time;
  board_time_init(&time, 0xFFFFFFF0u);
  EXPECT_EQ(board_time_update(&time, 0xFFFFFFFFu), 0xFFFFFFFFull);
  EXPECT_EQ(board_time_update(&time, 0), 0x100000000ull);
  EXPECT_EQ(board_time_update(&time, 0), 0x100000000ull);
  EXPECT_EQ(board_time_update(&time, 0xFFFFFFFFu), 0x1FFFFFFFFull);
  EXPECT_EQ(board_time_update(&time, 5), 0x200000005ull);
}

TEST(BoardTime, StampsOnBothSidesOfNowAndOfAWrapFindTheirTurn) {
  std::mt19937_64 random(1);
  board_time time;
  board_time_init(&time, 0);
  std::uint64_t now = 0;
  for (int i = 0; i < 100'000; ++i) {
    now += random() % 0x7FFFFFFFu;
    EXPECT_EQ(board_time_update(&time, static_cast<std::uint32_t>(now)), now);
    const std::uint64_t back = random() % (now < 0x7FFFFFFFu ? now + 1 : 0x7FFFFFFFu);
    ASSERT_EQ(board_time_of(&time, static_cast<std::uint32_t>(now - back)), now - back);
    const std::uint64_t ahead = random() % 0x7FFFFFFFu;
    ASSERT_EQ(board_time_of(&time, static_cast<std::uint32_t>(now + ahead)), now + ahead);
  }
}

TEST(BoardTime, NanosecondsAreTheNearestToTheExactOnes) {
  std::mt19937_64 random(2);
  for (const std::uint32_t hz : {1'000'000u, 25'000'000u, 84'000'000u, 168'000'000u})
    for (int i = 0; i < 10'000; ++i) {
      const std::uint64_t ticks = random() % (std::uint64_t{hz} * 86'400 * 365 * 100);
      const auto exact =
          static_cast<std::uint64_t>((static_cast<unsigned __int128>(ticks) * 1'000'000'000u + hz / 2) / hz);
      ASSERT_EQ(ticks_to_ns(ticks, hz), exact);
      // A tick is at least 5 ns: its nanoseconds name it.
      ASSERT_EQ(ns_to_ticks(static_cast<std::int64_t>(exact), hz), static_cast<std::int64_t>(ticks));
      ASSERT_EQ(ns_to_ticks(-static_cast<std::int64_t>(exact), hz), -static_cast<std::int64_t>(ticks));
    }
}

}  // namespace
