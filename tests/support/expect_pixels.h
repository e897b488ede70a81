// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "calibration/lens_import/projections.h"
#include "lighting/vector.h"

namespace lightwell::test {

inline void expect_pixels(const calibration::Projection& project, const std::vector<Vec3d>& directions,
                          const std::vector<Vec2d>& pixels, double tolerance) {
  ASSERT_LE(pixels.size(), directions.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const auto pixel = project(directions[i]);
    ASSERT_TRUE(pixel) << i;
    EXPECT_LT((*pixel - pixels[i]).norm(), tolerance) << i;
  }
}

}  // namespace lightwell::test
