// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/followed_writers.h"

#include <gtest/gtest.h>

namespace lightwell {
namespace {

using namespace std::chrono_literals;

const auto kThere = [](std::uint64_t) { return true; };
const auto kGone = [](std::uint64_t) { return false; };

TEST(FollowedWriters, OfTwoOfOneNameTheFirstIsFollowedUntilItIsSilentOrGone) {
  FollowedWriters writers(2s);
  const FollowedWriters::Time begin{};
  EXPECT_TRUE(writers.follows("left", 1, begin, kThere));
  EXPECT_TRUE(writers.follows("right", 2, begin, kThere));
  EXPECT_TRUE(writers.contested().empty());
  EXPECT_FALSE(writers.follows("left", 2, begin + 1s, kThere));
  EXPECT_TRUE(writers.follows("left", 1, begin + 1s, kThere));
  EXPECT_EQ(writers.contested().size(), 1u);
  EXPECT_TRUE(writers.contested().contains("left"));
  EXPECT_FALSE(writers.follows("left", 2, begin + 3s, kThere));
  EXPECT_TRUE(writers.follows("left", 2, begin + 3001ms, kThere)) << "2 s after the first was heard";
  EXPECT_FALSE(writers.follows("left", 1, begin + 4s, kThere)) << "it does not come back";
  EXPECT_TRUE(writers.follows("left", 3, begin + 4s, kGone));
}

TEST(FollowedWriters, AWriterThatIsStartedAgainIsNotContested) {
  FollowedWriters writers(2s);
  EXPECT_TRUE(writers.follows("left", 1, {}, kThere));
  EXPECT_TRUE(writers.follows("left", 2, {}, kGone));
  EXPECT_TRUE(writers.contested().empty());
}

}  // namespace
}  // namespace lightwell
