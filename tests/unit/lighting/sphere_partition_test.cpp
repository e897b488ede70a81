// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/sphere_partition.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace lightwell {
namespace {

TEST(SpherePartition, ACellHoldsItsCentre) {
  for (const int cells : {2, 3, 7, 50, 3072}) {
    const SpherePartition sphere(cells);
    ASSERT_EQ(sphere.cells(), cells);
    for (int i = 0; i < cells; ++i) EXPECT_EQ(sphere.cell_of(sphere.centre(i)), i) << cells;
  }
}

// Equal heights times equal azimuths are equal areas: of a fine lattice of them every cell gets its part.
TEST(SpherePartition, CellsAreEqualInArea) {
  constexpr int kCells = 200, kHeights = 2000, kAzimuths = 2000;
  const SpherePartition sphere(kCells);
  std::vector<int> count(kCells);
  for (int i = 0; i < kHeights; ++i)
    for (int j = 0; j < kAzimuths; ++j) {
      const double y = 1 - (2 * i + 1.0) / kHeights, lambda = 2 * kPi * (j + 0.5) / kAzimuths;
      const double h = std::sqrt(1 - y * y);
      ++count[static_cast<std::size_t>(sphere.cell_of({h * std::sin(lambda), y, h * std::cos(lambda)}))];
    }
  // A cell is 20,000 of them: some 250 rows of 80, one more or less of either.
  for (const int c : count) EXPECT_NEAR(c, kHeights * kAzimuths / kCells, 330);
}

TEST(SpherePartition, CellsAreSmallAllAround) {
  const SpherePartition sphere(3072);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 2000; ++i) {
    const Vec3d d = Vec3d(normal(random), normal(random), normal(random)).normalized();
    // Leopardi proves a diameter below 7 / √cells, and finds 6.5; a corner is half of it off the centre.
    EXPECT_LT(std::acos(std::min(1.0, d.dot(sphere.centre(sphere.cell_of(d))))), 3.5 / std::sqrt(3072.0));
  }
}

TEST(DirectionCount, GrowsWithTheLongestWayOfRaysThroughAGrid) {
  const auto count = [](std::array<int, 3> size, const Vec3d& high) {
    return direction_count_for(FieldGrid{size, Vec3d::Zero(), high});
  };
  const auto of_points = [](double n) { return static_cast<int>(std::lround(kPi * n * n)); };
  EXPECT_EQ(count({2, 2, 2}, {1, 1, 1}), 3072);
  EXPECT_EQ(count({64, 64, 64}, {1, 1, 1}), of_points(64));
  EXPECT_EQ(count({101, 26, 101}, {2, 0.5, 2}), of_points(101)) << "a stage: light comes from its sides, too";
  EXPECT_EQ(count({101, 26, 26}, {2, 0.5, 0.5}), of_points(101)) << "four times as long as wide";
  EXPECT_EQ(count({401, 26, 26}, {8, 0.5, 0.5}), of_points(101)) << "a corridor of the same width";
  EXPECT_EQ(count({1000, 2, 2}, {999, 1, 1}), 3072) << "a row of points";
  EXPECT_EQ(count({512, 2, 2}, {1, 1, 1}), of_points(512)) << "thin cells, across which rays go a long way";
  EXPECT_EQ(count({4096, 4096, 2}, {1, 1, 0.001}), kMostFieldDirections);
}

}  // namespace
}  // namespace lightwell
