// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/flat_field.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace lightwell {
namespace {

void expect_refused(const FlatField& flat, const std::string& start) {
  const Status status = check(flat, Lens{});
  ASSERT_FALSE(status) << start;
  EXPECT_EQ(status.error().kind, ErrorKind::bad_input);
  EXPECT_EQ(status.error().message.substr(0, start.size()), start);
}

TEST(FlatField, TransmissionIsItsPolynomial) {
  const FlatField flat{{0, 0}, {}, {-0.1, 0.02, -0.003}};
  EXPECT_DOUBLE_EQ(flat.transmission(0), 1);
  EXPECT_NEAR(flat.transmission(1.2), 1 - 0.1 * 1.44 + 0.02 * 1.44 * 1.44 - 0.003 * 1.44 * 1.44 * 1.44,
              1e-15);
}

TEST(FlatField, NothingToCorrectFitsEveryLens) {
  EXPECT_TRUE(check(FlatField{}, Lens{}));
}

TEST(FlatField, CheckNamesFieldValueAndRange) {
  FlatField flat{{640, 480}, std::vector<float>(640 * 480), {-0.2, 0, 0}};
  EXPECT_TRUE(check(flat, Lens{}));
  flat.image_size = {640, 481};
  expect_refused(flat, "flat.image_size[1] = 481: allowed 480");
  flat.image_size = {640, 480};
  flat.offset_codes[7] = std::numeric_limits<float>::quiet_NaN();
  expect_refused(flat, "flat.offset_codes[7] = nan");
  flat.offset_codes.resize(10);
  expect_refused(flat, "flat.offset_codes: number of values = 10");
  flat.offset_codes.clear();
  flat.vignetting = {-0.41, 0, 0};  // 1 − 0.41 θ² is negative at 90 degrees
  expect_refused(flat, "flat.vignetting: transmission at 90");
  flat.vignetting = {-2, 0.99, 0};  // touches below zero inside the field, positive at its border
  expect_refused(flat, "flat.vignetting: transmission at 57");
}

}  // namespace
}  // namespace lightwell
