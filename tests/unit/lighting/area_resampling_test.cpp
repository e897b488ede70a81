// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/luminaire/area_resampling.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lightwell {
namespace {

// A mesh of quads that tiles more than the grid, its lines bent and turned.
AreaResampling::Quad bent(double x, double y, double side) {
  const auto at = [](double a, double b) {
    return Vec2d(a + 0.2 * b + 0.03 * std::sin(a * b), b - 0.3 * a + 0.02 * std::cos(3 * a));
  };
  return {at(x, y), at(x + side, y), at(x + side, y + side), at(x, y + side)};
}

TEST(AreaResampling, AnEvenPictureStaysEvenAndCoversAll) {
  for (const double side : {0.013, 0.07, 0.31}) {  // finer than the grid's pixels, and coarser
    AreaResampling grid({8, 5}, {-1, -0.5}, {1, 0.5});
    for (double y = -2; y < 2; y += side)
      for (double x = -2; x < 2; x += side) grid.add(bent(x, y, side), Rgbd(1, 2, 3));
    for (int row = 0; row < 5; ++row)
      for (int column = 0; column < 8; ++column) {
        EXPECT_NEAR(grid.covered(column, row), 1, 1e-9) << "no seam, no overlap";
        EXPECT_LT((grid.mean(column, row) - Rgbd(1, 2, 3)).abs().maxCoeff(), 1e-12);
      }
  }
}

TEST(AreaResampling, LightTimesAreaIsKept) {
  AreaResampling grid({7, 6}, {-1, -1}, {1, 1});
  double given = 0;
  for (double y = -0.4; y < 0.39; y += 0.05)
    for (double x = -0.5; x < 0.49; x += 0.05) {
      const auto quad = bent(x, y, 0.05);
      const double value = 1 + x * x + std::sin(5 * y);
      const double area = grid.add(quad, Rgbd::Constant(value));
      EXPECT_NEAR(area, grid.shared_area(quad), 1e-15);
      given += area * value;
    }
  double kept = 0;
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 7; ++column)
      kept += grid.mean(column, row)[0] * grid.covered(column, row) * (2.0 / 7) * (2.0 / 6);
  EXPECT_NEAR(kept, given, 1e-12);
}

TEST(AreaResampling, AQuadIsSharedOutByArea) {
  AreaResampling grid({2, 2}, {0, 0}, {2, 2});
  // A square on its corner about (1, 1.25), a quarter above the line y = 1 less than below.
  EXPECT_NEAR(grid.add({Vec2d(1, 0.75), Vec2d(1.5, 1.25), Vec2d(1, 1.75), Vec2d(0.5, 1.25)}, Rgbd::Ones()),
              0.5, 1e-15);
  EXPECT_NEAR(grid.covered(0, 0), 0.03125, 1e-15);
  EXPECT_NEAR(grid.covered(1, 0), 0.03125, 1e-15);
  EXPECT_NEAR(grid.covered(0, 1), 0.21875, 1e-15);
  EXPECT_NEAR(grid.covered(1, 1), 0.21875, 1e-15);
}

TEST(AreaResampling, WhatLiesOutsideOrIsNoPlaceAddsNothing) {
  AreaResampling grid({2, 2}, {0, 0}, {2, 2});
  const double nan = std::nan("");
  EXPECT_EQ(grid.add({Vec2d(3, 0), Vec2d(4, 0), Vec2d(4, 1), Vec2d(3, 1)}, Rgbd::Ones()), 0);
  EXPECT_EQ(grid.add({Vec2d(nan, nan), Vec2d(1, 0), Vec2d(1, 1), Vec2d(0, 1)}, Rgbd::Ones()), 0);
  EXPECT_EQ(grid.add({Vec2d(0, 0), Vec2d(1, nan), Vec2d(1, 1), Vec2d(0, 1)}, Rgbd::Ones()), 0);
  EXPECT_EQ(grid.mean(0, 0)[0], 0);
}

// A quadratic f = x² has f'' = 2: its mean over places of variance v about the middle is f(middle) + v.
TEST(AreaResampling, TheBlurIsTheVarianceOfWhatWasAveraged) {
  for (const double side : {0.125, 0.2, 0.5, 1.0}) {  // of the grid's pixels
    AreaResampling grid({12, 2}, {0, 0}, {12, 2});
    for (double y = 0; y < 2 - 1e-9; y += side)
      for (double x = 0; x < 12 - 1e-9; x += side) {
        const double mean = std::pow(x + side / 2, 2) + side * side / 12;  // over the quad itself
        grid.add({Vec2d(x, y), Vec2d(x + side, y), Vec2d(x + side, y + side), Vec2d(x, y + side)},
                 Rgbd::Constant(mean));
      }
    double excess = 0;
    for (int column = 0; column < 12; ++column)
      excess += (grid.mean(column, 0)[0] - std::pow(column + 0.5, 2)) / 12;
    EXPECT_NEAR(grid.blur_variance().x(), excess, 1e-9) << side;
    EXPECT_NEAR(excess, 1.0 / 12, 1e-9) << "whole pixels in a pixel: no more than its own width";
  }
}

}  // namespace
}  // namespace lightwell
