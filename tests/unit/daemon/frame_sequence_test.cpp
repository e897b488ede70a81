// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/frame_sequence.h"

#include <gtest/gtest.h>

namespace lightwell {
namespace {

TEST(FrameSequence, StartsAtZeroWhateverTheFirstIdIs) {
  for (const std::uint64_t first : {1U, 65401U, 65535U, 70000U}) {
    FrameSequence sequence;
    EXPECT_EQ(sequence.next(first).sequence, 0U) << first;
    EXPECT_EQ(sequence.next(first == 65535U ? 1 : first + 1).sequence, 1U) << first;
  }
}

TEST(FrameSequence, WrapSkipsZeroAndLosesNothing) {
  FrameSequence sequence;
  std::uint64_t id = 65401;  // where the simulated camera starts
  for (std::uint64_t i = 0; i < 200'000; ++i) {
    const auto step = sequence.next(id);
    ASSERT_EQ(step.sequence, i);
    ASSERT_EQ(step.lost, 0U);
    id = id == 65535 ? 1 : id + 1;
  }
}

TEST(FrameSequence, GapIsLostAlsoAcrossTheWrap) {
  FrameSequence sequence;
  sequence.next(65533);
  const auto step = sequence.next(2);  // 65534, 65535 and 1 never came
  EXPECT_EQ(step.lost, 3U);
  EXPECT_EQ(step.sequence, 4U);
}

TEST(FrameSequence, LongIdsCountOnBeyondSixteenBits) {
  FrameSequence sequence;
  sequence.next(65535);
  EXPECT_EQ(sequence.next(65536).sequence, 1U);
  EXPECT_EQ(sequence.next(65537).sequence, 2U);
  EXPECT_EQ(sequence.next(1'000'000'000'000).lost, 1'000'000'000'000U - 65537 - 1);
}

TEST(FrameSequence, IdsThatJumpBackAreADeviceThatBeganAnew) {
  FrameSequence sequence;
  sequence.next(5000);
  const auto step = sequence.next(1000);
  EXPECT_EQ(step.sequence, 1U);
  EXPECT_EQ(step.lost, 0U);
  EXPECT_EQ(sequence.next(1000).sequence, 2U) << "the same id twice must not repeat a number";
}

TEST(FrameSequence, GoesOnAfterAReconnection) {
  FrameSequence sequence;
  sequence.next(10);
  sequence.next(11);
  sequence.reconnected();
  const auto step = sequence.next(40000);
  EXPECT_EQ(step.sequence, 2U);
  EXPECT_EQ(step.lost, 0U);
}

TEST(FrameSequence, IncompleteFrameIsNotLostASecondTime) {
  FrameSequence named;
  named.next(1);
  EXPECT_EQ(named.incomplete(2), 0U);
  const auto after_named = named.next(3);
  EXPECT_EQ(after_named.lost, 0U);
  EXPECT_EQ(after_named.sequence, 2U);

  FrameSequence unnamed;
  unnamed.next(7);
  EXPECT_EQ(unnamed.incomplete(0), 0U);         // the leader was among the missing packets
  EXPECT_EQ(unnamed.incomplete(3), 0U);         // or the buffer still carries an old id
  const auto after_unnamed = unnamed.next(11);  // 8, 9, 10 are missing, two of them have been counted
  EXPECT_EQ(after_unnamed.lost, 1U);
  EXPECT_EQ(after_unnamed.sequence, 4U);
}

TEST(FrameSequence, GapBeforeAnIncompleteFrameIsLost) {
  FrameSequence sequence;
  sequence.next(1);
  EXPECT_EQ(sequence.incomplete(4), 2U);
}

}  // namespace
}  // namespace lightwell
