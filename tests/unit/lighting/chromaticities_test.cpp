// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/chromaticities.h"

#include <gtest/gtest.h>

#include <limits>

namespace lightwell {
namespace {

const Chromaticities kRec2020{{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, {0.3127, 0.3290}};
const Chromaticities kAces{{0.7347, 0.2653}, {0, 1}, {0.0001, -0.0770}, {0.32168, 0.33767}};

void expect_rows(const Chromaticities& space, const Eigen::Matrix3d& rows, double tolerance) {
  const auto matrix = rec709_from(space);
  ASSERT_TRUE(matrix);
  EXPECT_LT((*matrix - rows).cwiseAbs().maxCoeff(), tolerance) << *matrix;
}

TEST(Chromaticities, Rec709IsItself) {
  EXPECT_TRUE(is_rec709({}));
  expect_rows({}, Eigen::Matrix3d::Identity(), 1e-12);  // double rounding through two inverses
}

TEST(Chromaticities, Rec2020BecomesRec709AsPublished) {
  Eigen::Matrix3d published;  // ITU-R BT.2407-0, section 2
  published << 1.6605, -0.5876, -0.0728, -0.1246, 1.1329, -0.0083, -0.0182, -0.1006, 1.1187;
  EXPECT_FALSE(is_rec709(kRec2020));
  expect_rows(kRec2020, published, 1e-4);  // four digits are printed
}

TEST(Chromaticities, AcesBecomesRec709AsPublished) {
  Eigen::Matrix3d published;  // of the ACES reference transforms: AP0 to XYZ, Bradford to D65, XYZ to sRGB
  published << 2.52169, -1.13413, -0.38756, -0.27648, 1.37272, -0.09624, -0.01538, -0.15298, 1.16835;
  EXPECT_FALSE(is_rec709(kAces));
  expect_rows(kAces, published, 1e-3);  // whose sRGB matrix and D65 are rounded to four digits
}

TEST(Chromaticities, WhiteStaysWhite) {
  const Chromaticities xyz{{1, 0}, {0, 1}, {0, 0}, {1.0 / 3, 1.0 / 3}};
  for (const Chromaticities& space : {kRec2020, kAces, xyz}) {
    const auto matrix = rec709_from(space);
    ASSERT_TRUE(matrix);
    // double rounding through two inverses
    EXPECT_LT((*matrix * Eigen::Vector3d::Ones() - Eigen::Vector3d::Ones()).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(Chromaticities, NumbersThatAreNoColourSpaceAreRefused) {
  Chromaticities line;
  line.blue = (line.red + line.green) / 2;
  EXPECT_FALSE(rec709_from(line));
  Chromaticities dark;
  dark.white = {0.3, 0};
  EXPECT_FALSE(rec709_from(dark));
  Chromaticities unknown;
  unknown.red.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(is_rec709(unknown));
  EXPECT_FALSE(rec709_from(unknown));
  const Eigen::Vector2d zero(0, 0);
  EXPECT_FALSE(rec709_from({zero, zero, zero, zero}));
}

}  // namespace
}  // namespace lightwell
