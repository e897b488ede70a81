// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/surface_distance.h"

#include <gtest/gtest.h>

#include <vector>

namespace lightwell::render {
namespace {

// A square of two triangles, and above it a tilted triangle over both, whose highest corner is 1 away.
const std::vector<Vec3f> kCorners = {{-10, -10, 0},  {10, -10, 0},  {10, 10, 0}, {-10, 10, 0},
                                     {-3, -2, 0.5f}, {3, -2, 0.5f}, {0, 4, 1}};
const std::vector<std::uint32_t> kSquare = {0, 1, 2, 0, 2, 3};
const std::vector<std::uint32_t> kTilted = {4, 5, 6};

TEST(SurfaceDistance, IsNeverWithinWhereItIsAboveByPartsPerTenMillion) {
  for (const double less : {1e-7, 5e-7, 9e-7, 2e-6, 1e-3})
    EXPECT_FALSE(lies_within(kTilted, kSquare, kCorners, 1 - less)) << less;
}

TEST(SurfaceDistance, IsWithinWhereItIsBelowByMoreThanTheTolerance) {
  for (const double more : {2e-6, 1e-3, 1.0})
    EXPECT_TRUE(lies_within(kTilted, kSquare, kCorners, 1 + more)) << more;
}

TEST(SurfaceDistance, OfASurfaceFromItselfIsWithinAnything) {
  for (const double distance_m : {1e-9, 1e-3, 1.0})
    EXPECT_TRUE(stay_together(kSquare, kSquare, kCorners, distance_m)) << distance_m;
}

TEST(SurfaceDistance, IsOfBothSurfaces) {
  EXPECT_TRUE(lies_within(kTilted, kSquare, kCorners, 1.1));
  EXPECT_FALSE(stay_together(kTilted, kSquare, kCorners, 1.1));
}

}  // namespace
}  // namespace lightwell::render
