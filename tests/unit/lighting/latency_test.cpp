// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/evaluation/latency.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace lightwell {
namespace {

std::vector<Vec3d> series(int frames, const std::function<double(double)>& value) {
  std::vector<Vec3d> result;
  for (int t = 0; t < frames; ++t) result.emplace_back(value(t), 2 * value(t), 0);
  return result;
}

// The cubic ease of a light coming up over ten frames.
double ramp(double t) {
  const double u = std::clamp((t - 40) / 10, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

TEST(Lag, EqualSeriesHaveNone) {
  const auto a = series(80, ramp);
  EXPECT_EQ(lag_frames(a, a), 0);
}

TEST(Lag, IsTheDelayBetweenFramesToo) {
  for (const double delay : {0.5, 1.0, 2.3, 4.0, 8.0})
    EXPECT_NEAR(lag_frames(series(80, [&](double t) { return ramp(t - delay); }), series(80, ramp)), delay,
                0.05)
        << delay;  // the valley of a smooth ramp's differences, through three points
}

TEST(Lag, AConstantErrorAndAScaleDoNotMatter) {
  const auto reference = series(80, ramp);
  const auto late = series(80, [](double t) { return 100 + ramp(t - 3); });
  EXPECT_NEAR(lag_frames(late, reference), 3, 0.01);  // 3 is a whole frame
  auto small = reference;
  for (Vec3d& v : small) v *= 1e-30;
  EXPECT_EQ(lag_frames(small, small), 0);
}

TEST(Lag, NoneIsToldOfAStillSeriesAFewFramesOrNoise) {
  const auto still = series(80, [](double) { return 5.0; });
  EXPECT_TRUE(std::isnan(lag_frames(series(80, ramp), still)));
  EXPECT_TRUE(std::isnan(lag_frames(series(12, ramp), series(12, ramp))));
  EXPECT_TRUE(std::isnan(lag_frames(series(80, [](double t) { return ramp(t - 14); }), series(80, ramp))));
  std::mt19937 random(2);
  const auto noise = [&](double) { return static_cast<double>(random()) * 0x1p-32; };
  const auto a = series(80, noise);
  EXPECT_TRUE(std::isnan(lag_frames(a, series(80, noise))));
  EXPECT_NEAR(lag_frames(a, a), 0, 0.2);  // its neighbours differ by chance
}

}  // namespace
}  // namespace lightwell
