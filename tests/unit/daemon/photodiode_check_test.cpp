// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/photodiode_check.h"

#include <gtest/gtest.h>

#include <limits>

namespace lightwell {
namespace {

TEST(PhotodiodeCheck, SaysNothingBeforeItHasSeenEnough) {
  PhotodiodeCheck check;
  for (std::size_t i = 0; i + 1 < PhotodiodeCheck::kEnough; ++i) check.add(500, 2000);
  EXPECT_FALSE(check.verdict());
  check.add(500, 2000);
  ASSERT_TRUE(check.verdict());
  EXPECT_TRUE(check.verdict()->differs);
  EXPECT_DOUBLE_EQ(check.verdict()->ratio, 4);
  check.reset();
  EXPECT_FALSE(check.verdict());
}

TEST(PhotodiodeCheck, ALampThatComesOnBetweenTheTwoReadingsIsNoFault) {
  PhotodiodeCheck check;
  for (int i = 0; i < 20; ++i) check.add(500, i % 4 == 0 ? 5000 : 520);
  ASSERT_TRUE(check.verdict());
  EXPECT_FALSE(check.verdict()->differs);
  EXPECT_DOUBLE_EQ(check.verdict()->ratio, 1.04);
}

TEST(PhotodiodeCheck, DifferenceInEitherSenseIsAFaultAndItsEndEndsIt) {
  PhotodiodeCheck check;
  for (int i = 0; i < 20; ++i) check.add(500, 350);
  EXPECT_TRUE(check.verdict()->differs) << "a dirty dome";
  for (int i = 0; i < 20; ++i) check.add(500, 480);
  EXPECT_FALSE(check.verdict()->differs);
}

TEST(PhotodiodeCheck, DarknessAndBrokenReadingsSayNothing) {
  PhotodiodeCheck check;
  for (int i = 0; i < 20; ++i) {
    check.add(0.2, 0.1);
    check.add(500, 0);
    check.add(-3, 500);
    check.add(500, std::numeric_limits<double>::quiet_NaN());
    check.add(std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity());
  }
  EXPECT_FALSE(check.verdict());
}

}  // namespace
}  // namespace lightwell
