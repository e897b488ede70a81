// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/temporal/light_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lighting/temporal/fir_design.h"

namespace lightwell {
namespace {

std::vector<double> paper_like_taps() {
  return design_fir({21, 5.9, 8.05, 8}).value().taps;
}

LightArrays lights_of_power(std::size_t count, float power) {
  LightArrays lights(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double lambda = 2 * kPi * static_cast<double>(i) / static_cast<double>(count);
    lights.x[i] = static_cast<float>(0.6 * std::sin(lambda));
    lights.y[i] = 0.8f;
    lights.z[i] = static_cast<float>(0.6 * std::cos(lambda));
    lights.r[i] = power;
    lights.g[i] = 2 * power;
    lights.b[i] = 3 * power;
  }
  return lights;
}

double sum(const std::vector<float>& v) {
  double s = 0;
  for (const float x : v) s += static_cast<double>(x);
  return s;
}

TEST(LightFilter, FirstFrameComesOutAsItWentIn) {
  LightFilter filter(paper_like_taps(), 10, kPi / 2);
  const LightArrays in = lights_of_power(10, 5);
  LightArrays out(10);
  for (int frame = 0; frame < 20; ++frame) {
    filter.apply(in, out);
    for (std::size_t i = 0; i < 10; ++i) {  // float rounding of nine products
      EXPECT_NEAR(out.x[i], in.x[i], 1e-6);
      EXPECT_NEAR(out.y[i], in.y[i], 1e-6);
      EXPECT_NEAR(out.r[i], in.r[i], 1e-5);
    }
  }
}

TEST(LightFilter, SlowChangesPassWithTheDesignedDelay) {
  const auto taps = paper_like_taps();
  LightFilter filter(taps, 4, kPi / 2);
  LightArrays out(4);
  std::vector<double> in_total;
  for (int frame = 0; frame < 200; ++frame) {
    // .5 Hz at 21 Hz, deep inside the pass band
    const LightArrays in = lights_of_power(4, static_cast<float>(10 + std::sin(2 * kPi * 0.5 * frame / 21)));
    in_total.push_back(sum(in.r));
    filter.apply(in, out);
    if (frame < 20) continue;
    // Gain at .5 Hz is within 2 % of 1 for this design; the swing is a tenth of the total.
    EXPECT_NEAR(sum(out.r), in_total[static_cast<std::size_t>(frame - 4)], 0.02 * 4 + 1e-4) << frame;
  }
  EXPECT_EQ(filter.delay_frames(), 4);
}

TEST(LightFilter, AlternationAtHalfTheRateIsSuppressedAsDesigned) {
  const auto taps = design_fir({60, 8, 20, 16}).value().taps;
  const double gain = fir_gain(taps, 30, 60);
  LightFilter filter(taps, 3, kPi / 2);
  LightArrays out(3);
  for (int frame = 0; frame < 60; ++frame) {
    filter.apply(lights_of_power(3, frame % 2 == 0 ? 12.0f : 8.0f), out);
    if (frame > 20) {
      EXPECT_NEAR(sum(out.r), 3 * 10.0, 3 * 2 * gain + 1e-3);
    }
  }
}

TEST(LightFilter, SpikeIsBoundedNeverNegativeAndForgotten) {
  LightFilter filter(paper_like_taps(), 5, kPi / 2);
  LightArrays out(5);
  for (int frame = 0; frame < 40; ++frame) {
    filter.apply(lights_of_power(5, frame == 10 ? 100.0f : 1.0f), out);
    for (std::size_t i = 0; i < 5; ++i) {
      EXPECT_GE(out.r[i], 1 - 1e-5f) << frame;  // never below what was there
      EXPECT_LE(out.r[i], 100 + 1e-3f) << frame;
    }
    if (frame < 10 || frame > 18) {
      EXPECT_NEAR(sum(out.r), 5, 1e-4) << frame;
    }
  }
}

TEST(LightFilter, SpikeOfOneLightIsBoundedToo) {
  LightFilter filter(paper_like_taps(), 5, kPi / 2);
  LightArrays out(5);
  for (int frame = 0; frame < 40; ++frame) {
    LightArrays in = lights_of_power(5, 1);
    if (frame == 10) in.r[2] = 100;
    filter.apply(in, out);
    for (std::size_t i = 0; i < 5; ++i) EXPECT_GE(out.r[i], 0) << frame;
    EXPECT_GE(sum(out.r), 5 - 1e-4);
    EXPECT_LE(sum(out.r), 104 + 1e-2);
  }
}

TEST(LightFilter, ConstantTotalStaysConstantWhileLightsTradePower) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> share(0, 1);
  LightFilter filter(paper_like_taps(), 8, kPi / 2);
  LightArrays out(8);
  for (int frame = 0; frame < 60; ++frame) {
    LightArrays in = lights_of_power(8, 1);
    for (float& v : in.r) v = share(random);
    const double total = sum(in.r);
    for (float& v : in.r) v = static_cast<float>(v * 7 / total);
    filter.apply(in, out);
    EXPECT_NEAR(sum(out.r), 7, 1e-5);  // float rounding of eight lights
    for (const float v : out.r) EXPECT_GE(v, 0);
  }
}

TEST(LightFilter, OppositeDirectionsKeepAUnitDirection) {
  const std::vector<double> half = {0.5, 0.5};
  LightFilter filter(half, 1, kPi);
  LightArrays in(1), out(1);
  in.x[0] = 1;
  in.y[0] = 0;
  filter.apply(in, out);
  for (int frame = 1; frame < 6; ++frame) {
    in.x[0] = -in.x[0];
    filter.apply(in, out);
    EXPECT_EQ(out.x[0], 1) << "kept what it had";
    EXPECT_EQ(out.y[0], 0);
  }
}

TEST(LightFilter, DirectionsAreUnitAndNeverBelowTheEdge) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const double edge_deg : {60.0, 90.0, 110.0, 180.0}) {
    const double edge = edge_deg * kPi / 180;
    LightFilter filter(paper_like_taps(), 50, edge);
    LightArrays in(50), out(50);
    for (int frame = 0; frame < 100; ++frame) {
      for (std::size_t i = 0; i < 50; ++i) {  // lights near the edge, jumping wildly
        const double theta = edge * (1 - 0.2 * uniform(random) * uniform(random));
        const double lambda = 2 * kPi * uniform(random);
        in.x[i] = static_cast<float>(std::sin(theta) * std::sin(lambda));
        in.y[i] = static_cast<float>(std::cos(theta));
        in.z[i] = static_cast<float>(std::sin(theta) * std::cos(lambda));
      }
      filter.apply(in, out);
      for (std::size_t i = 0; i < 50; ++i) {
        const double length = std::hypot(out.x[i], out.y[i], out.z[i]);
        EXPECT_NEAR(length, 1, 1e-5);                            // float rounding
        EXPECT_GE(out.y[i], std::cos(edge) - 1e-6) << edge_deg;  // float rounding
      }
    }
  }
}

TEST(LightFilter, HorizonIsExactlyZeroForAHemisphere) {
  // Straight overshoot below the horizon: rising light, negative taps.
  LightFilter filter(paper_like_taps(), 1, kPi / 2);
  LightArrays in(1), out(1);
  for (int frame = 0; frame < 30; ++frame) {
    const double theta = frame < 5 ? 30 * kPi / 180 : kPi / 2;
    in.x[0] = static_cast<float>(std::sin(theta));
    in.y[0] = static_cast<float>(std::max(0.0, std::cos(theta)));
    filter.apply(in, out);
    EXPECT_GE(out.y[0], 0);
  }
}

TEST(LightFilter, ResetForgets) {
  LightFilter filter(paper_like_taps(), 2, kPi / 2);
  LightArrays out(2);
  filter.apply(lights_of_power(2, 50), out);
  filter.reset();
  filter.apply(lights_of_power(2, 1), out);
  EXPECT_NEAR(sum(out.r), 2, 1e-5);
}

TEST(LightFilter, BlackFramesStayBlackAndBrightnessReturns) {
  LightFilter filter(paper_like_taps(), 3, kPi / 2);
  LightArrays out(3);
  for (int frame = 0; frame < 40; ++frame) {
    const bool black = frame < 20;
    filter.apply(lights_of_power(3, black ? 0.0f : 4.0f), out);
    if (black) {
      EXPECT_EQ(sum(out.r), 0);
    }
    if (frame >= 29) {
      EXPECT_NEAR(sum(out.r), 12, 1e-4);
    }
    for (const float v : out.r) EXPECT_TRUE(std::isfinite(v) && v >= 0);
  }
}

}  // namespace
}  // namespace lightwell
