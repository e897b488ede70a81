// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/luminaire/srgbe.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace lightwell {
namespace {

Rgb through(const Rgb& value) {
  return from_srgbe(to_srgbe(value));
}
void expect_close(const Rgb& value) {
  const float largest = value.abs().maxCoeff();
  EXPECT_LE((through(value) - value).abs().maxCoeff(), largest / 128 + 0x1p-135f) << value.transpose();
}

TEST(Srgbe, ZeroPowersOfTwoAndSignsAreExact) {
  EXPECT_TRUE((through(Rgb::Zero()) == 0).all());
  EXPECT_TRUE((through(-Rgb::Zero()) == 0).all());
  for (int k = -128; k <= 127; ++k) {
    const float power = std::ldexp(1.0f, k);
    for (const Rgb& value : {Rgb(power, 0, 0), Rgb(0, -power, 0), Rgb(power, -power, power / 2)})
      EXPECT_TRUE((through(value) == value).all()) << k;
  }
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  for (int i = 0; i < 1000; ++i) {
    const Rgb value(normal(random), normal(random), normal(random));
    EXPECT_TRUE((through(-value) == -through(value)).all());
  }
}

TEST(Srgbe, AMillionRandomValuesAreWithinA128th) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> mantissa(-1, 1);
  std::uniform_int_distribution<int> exponent(-120, 126);
  float worst = 0;
  for (int i = 0; i < 1000000; ++i) {
    const Rgb value =
        Rgb(mantissa(random), mantissa(random), mantissa(random)) * std::ldexp(1.0f, exponent(random));
    worst = std::max(worst, (through(value) - value).abs().maxCoeff() / value.abs().maxCoeff());
  }
  EXPECT_LE(worst, 1.0f / 128);
}

TEST(Srgbe, SpecialValuesNeitherOverflowNorBecomeNothing) {
  constexpr float kMax = std::numeric_limits<float>::max(), kMin = std::numeric_limits<float>::min();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const float denormal = std::numeric_limits<float>::denorm_min();
  for (const float v :
       {kMax, -kMax, kMin, -kMin, denormal, 0x1.fffffep-1f, 0x1.fffffep+126f, 0x1p-127f, 0x1p-130f})
    expect_close(Rgb(v, 0, v / 3));
  EXPECT_TRUE(through(Rgb(kInfinity, -kInfinity, 0)).isFinite().all());
  EXPECT_GT(through(Rgb(kInfinity, 0, 0))[0], 0x1.fp+127f);
  EXPECT_TRUE((through(Rgb::Constant(std::nanf(""))) == 0).all());
  EXPECT_EQ(through(Rgb(1, std::nanf(""), 0))[0], 1) << "the others stay";
  // Just below a power of two: the last code, not the one past it.
  EXPECT_EQ(through(Rgb(std::nextafter(8.0f, 0.0f), 0, 0))[0], 8 * 127 / 128.0f);
}

// What a decoder may meet that no encoder of ours writes.
TEST(Srgbe, EveryCodeIsAFiniteNumber) {
  for (int e = 0; e < 256; ++e)
    for (const int m : {0, 1, 127, 128, 129, 255}) {
      const auto byte = static_cast<std::uint8_t>(m);
      EXPECT_TRUE(from_srgbe({{byte, byte, byte}, static_cast<std::uint8_t>(e)}).isFinite().all() ||
                  (m == 0 && e == 255));
    }
}

}  // namespace
}  // namespace lightwell
