// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/pictures/flip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace lightwell::pictures {
namespace {

LinearPicture filled(const Rgb& colour) {
  return {96, 64, std::vector<Rgb>(std::size_t{96} * 64, colour)};
}

// Ramps, squares of 8 pixels, a disc and a line, all but the ramps moved to the right.
LinearPicture pattern(int shift, float tint) {
  LinearPicture picture = filled(Rgb::Zero());
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 96; ++x) {
      Rgb& pixel = picture.pixels[static_cast<std::size_t>(y) * 96 + static_cast<std::size_t>(x)];
      pixel = Rgb(static_cast<float>(x) / 95, static_cast<float>(y) / 63,
                  static_cast<float>(((x + shift) / 8 + y / 8) % 2));
      const int from_middle = x - 30 - shift;
      if (from_middle * from_middle + (y - 30) * (y - 30) < 225) pixel = tint * Rgb(0.8f, 0.5f, 0.2f);
      if (x == 70 + shift) pixel = Rgb::Ones();
    }
  return picture;
}

double mean(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Values of the authors' own program (flip-evaluator 1.7), which works in single precision: filters of 21 × 21 and cube
// roots leave 1e-3.
TEST(Flip, AgreesWithTheAuthorsProgram) {
  const std::vector<float> error = flip(pattern(0, 1), pattern(2, 0.75f));
  EXPECT_NEAR(mean(error), 0.32549868, 1e-3);
  const struct {
    int x, y;
    double flip;
  } known[] = {{0, 0, 0.11395200},   {31, 30, 0.37428191}, {45, 30, 0.39636940}, {71, 10, 0.35972035},
               {95, 63, 0.96556950}, {60, 50, 0.23337091}, {12, 40, 0.11483049}};
  for (const auto& k : known)
    EXPECT_NEAR(
        static_cast<double>(error[static_cast<std::size_t>(k.y) * 96 + static_cast<std::size_t>(k.x)]),
        k.flip, 1e-3)
        << k.x << ", " << k.y;
  EXPECT_NEAR(mean(flip(filled(Rgb::Constant(0.5f)), filled(Rgb(0.5f, 0.25f, 0.5f)))), 0.67817760, 1e-3);
}

TEST(Flip, EqualPicturesDifferByNothingAndGreenFromBlueByEverything) {
  const std::vector<float> same = flip(pattern(0, 1), pattern(0, 1));
  EXPECT_EQ(*std::max_element(same.begin(), same.end()), 0);
  EXPECT_NEAR(mean(flip(filled(Rgb(0, 1, 0)), filled(Rgb(0, 0, 1)))), 1, 1e-4);  // single precision
}

}  // namespace
}  // namespace lightwell::pictures
