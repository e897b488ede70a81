// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/luminaire/position_grid.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lightwell {
namespace {

TEST(PositionGrid, PlacesFindTheirGridWhereverItLies) {
  for (const Vec2d& origin : {Vec2d(0, 0), Vec2d(0.0049, -0.0051), Vec2d(-3.00251, 17.12749)}) {
    std::vector<Vec2d> places;
    for (int v = 0; v < 3; ++v)
      for (int u = 0; u < 4; ++u) places.push_back(origin + 0.005 * Vec2d(3 - u, v));
    const PositionGrid grid = position_grid(places, 0.005);
    EXPECT_EQ(grid.positions, (std::array<int, 2>{4, 3}));
    EXPECT_LT((grid.first_m - origin).norm(), 1e-12);
    for (std::size_t i = 0; i < places.size(); ++i) {
      EXPECT_EQ(grid.at[i][0], 3 - static_cast<int>(i) % 4);
      EXPECT_EQ(grid.at[i][1], static_cast<int>(i) / 4);
      EXPECT_LT(grid.deviation_m[i], 1e-12);
    }
  }
}

TEST(PositionGrid, OneThatIsOffDoesNotMoveTheOthers) {
  std::vector<Vec2d> places;
  for (int i = 0; i < 49; ++i) places.emplace_back(i % 7, i / 7);
  places[0].x() += 0.3;  // the very first
  const PositionGrid grid = position_grid(places, 1);
  EXPECT_NEAR(grid.deviation_m[0], 0.3, 0.01);
  for (std::size_t i = 1; i < places.size(); ++i) EXPECT_LT(grid.deviation_m[i], 0.01);
}

LampImages cubic_images(int width, int height) {
  LampImages images;
  images.planes.positions = {width, height};
  images.planes.pixels = {2, 1};
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u)
      for (int s = 0; s < 2; ++s)
        images.values.emplace_back(
            Rgb(static_cast<float>(u * u * u - 3 * v * v * v), static_cast<float>(s + u * v), 1));
  return images;
}

TEST(CompletePositions, ACubicComesBackAndCornersDoNot) {
  const LampImages truth = cubic_images(6, 5);
  LampImages images = truth;
  std::vector<bool> measured(30, true);
  const auto drop = [&](int u, int v) {
    measured[images.planes.image(u, v)] = false;
    std::fill_n(images.image(u, v), 2, Rgb(Rgb::Zero()));
  };
  drop(2, 2);
  drop(0, 0);
  drop(5, 3);  // at an edge: along v alone, with two neighbours
  complete_positions(images, measured);
  EXPECT_TRUE(measured[images.planes.image(2, 2)]);
  EXPECT_FALSE(measured[images.planes.image(0, 0)]);
  EXPECT_TRUE(measured[images.planes.image(5, 3)]);
  for (int s = 0; s < 2; ++s) {
    EXPECT_LT((images.image(2, 2)[s] - truth.image(2, 2)[s]).abs().maxCoeff(), 1e-4F);
    EXPECT_EQ(images.image(0, 0)[s][1], 0);
    EXPECT_NEAR(images.image(5, 3)[s][0], 125 - 3 * (8 + 64) / 2.0, 1e-3) << "the mean of two";
  }
}

// Means over pixels of a quartic: what is left is of fourth order, p⁴ times the fourth derivative.
TEST(RestoreCentres, MeansBecomeTheValuesAtTheMiddles) {
  LampImages images;
  images.planes.pixels = {40, 30};
  const auto f = [](double x) { return std::sin(x); };
  const auto mean = [](double x, double p) { return (std::cos(x - p / 2) - std::cos(x + p / 2)) / p; };
  constexpr double kPixel = 0.2;
  for (int t = 0; t < 30; ++t)
    for (int s = 0; s < 40; ++s)
      images.values.emplace_back(
          Rgb::Constant(static_cast<float>(mean(s * kPixel, kPixel) + 2 * mean(t * kPixel + 1, kPixel))));
  const LampImages means = images;
  restore_centres(images, Vec2d::Constant(1.0 / 12));
  double before = 0, after = 0;
  for (int t = 1; t < 29; ++t)
    for (int s = 1; s < 39; ++s) {
      const auto i = static_cast<std::size_t>(t * 40 + s);
      const double truth = f(s * kPixel) + 2 * f(t * kPixel + 1);
      before = std::max(before, std::abs(static_cast<double>(means.values[i][0]) - truth));
      after = std::max(after, std::abs(static_cast<double>(images.values[i][0]) - truth));
    }
  EXPECT_GT(before, 4e-3);
  EXPECT_LT(after, 3e-5);
}

}  // namespace
}  // namespace lightwell
