// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/redundancy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lightwell {
namespace {

std::vector<Rgb> picture(float level) {
  return std::vector<Rgb>(10, Rgb::Constant(level));
}

std::vector<bool> kept_of(const std::vector<float>& levels, double step_m,
                          const RedundancyFilter::Limits& limits) {
  RedundancyFilter filter(limits);
  for (std::size_t i = 0; i < levels.size(); ++i)
    filter.add({step_m * static_cast<double>(i), 0, 0}, picture(levels[i]));
  return filter.kept();
}
std::size_t count(const std::vector<bool>& kept) {
  return static_cast<std::size_t>(std::count(kept.begin(), kept.end(), true));
}

TEST(PictureDifference, IsTheEnergyOfTheAbsoluteDifference) {
  EXPECT_EQ(picture_difference(picture(2), picture(2)), 0);
  EXPECT_NEAR(picture_difference(picture(1.1f), picture(0.9f)), 0.2, 1e-6);
  EXPECT_EQ(picture_difference(picture(0), picture(5)), 2);
  EXPECT_EQ(picture_difference(picture(0), picture(0)), 0);
  // Light that moves counts though its sum stays.
  std::vector<Rgb> a = picture(0), b = picture(0);
  a[2].setConstant(7);
  b[3].setConstant(7);
  EXPECT_EQ(picture_difference(a, b), 2);
  // What one of them did not see tells nothing.
  b = a;
  b[2].setConstant(std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(picture_difference(a, b), 0);
}

TEST(RedundancyFilter, EvenLightIsThinnedToTheSpacing) {
  // Every 10 mm a picture: of each 50 mm one is needed.
  const auto kept = kept_of(std::vector<float>(101, 1.0f), 0.01, {0.05, 0.0501});
  EXPECT_EQ(count(kept), 21u);
  for (std::size_t i = 0; i < kept.size(); ++i) EXPECT_EQ(kept[i], i % 5 == 0) << i;
}

TEST(RedundancyFilter, PicturesFarApartStay) {
  EXPECT_EQ(count(kept_of(std::vector<float>(30, 1.0f), 0.03, {0.05, 0.05})), 30u);
}

TEST(RedundancyFilter, AnEdgeKeepsThePicturesOnBothItsSides) {
  std::vector<float> levels(40, 1.0f);
  for (std::size_t i = 20; i < 40; ++i) levels[i] = 3;
  const auto kept = kept_of(levels, 0.001, {0.05, 1});
  EXPECT_TRUE(kept[0] && kept[19] && kept[20] && kept[39]);
  EXPECT_EQ(count(kept), 4u);
}

TEST(RedundancyFilter, ASlowDriftIsFollowed) {
  // 1 % a step: each is like its neighbours, but not like the one that was kept.
  std::vector<float> levels;
  for (int i = 0; i < 101; ++i) levels.push_back(std::pow(1.01f, static_cast<float>(i)));
  const auto kept = kept_of(levels, 0.0001, {0.05, 1});
  EXPECT_GE(count(kept), 18u);
  EXPECT_LE(count(kept), 23u) << "a step of 5 to 6 %";
}

}  // namespace
}  // namespace lightwell
