// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/temporal/flicker_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "lighting/vector.h"
#include "tests/support/allocation_counter.h"

namespace lightwell {
namespace {

// A lamp on the mains as a camera sees it: its light averaged over the exposure.
struct Camera {
  double rate_hz = 60;
  double exposure_s = 0.002;
  double flicker_hz = 100;
  [[nodiscard]] double time(int frame) const { return 7.3 + frame / rate_hz; }
  [[nodiscard]] double lamp(int frame, double depth, double phase = 0.4) const {
    const double x = kPi * flicker_hz * exposure_s;
    const double averaged = x == 0 ? 1 : std::sin(x) / x;
    return 1 + depth * averaged * std::cos(2 * kPi * flicker_hz * time(frame) + phase);
  }
};

std::vector<double> filtered(const Camera& camera, int frames, const std::function<double(int)>& power) {
  auto filter = FlickerFilter::create(1, {camera.flicker_hz, camera.rate_hz, camera.exposure_s}).value();
  std::vector<double> out;
  for (int frame = 0; frame < frames; ++frame) {
    std::array<float, 1> value = {static_cast<float>(power(frame))};
    filter.apply(camera.time(frame), camera.exposure_s, value);
    out.push_back(static_cast<double>(value[0]));
  }
  return out;
}

double swing(const std::vector<double>& values, std::size_t from) {
  const auto [low, high] =
      std::minmax_element(values.begin() + static_cast<std::ptrdiff_t>(from), values.end());
  return (*high - *low) / 2;
}

TEST(FlickerFilter, TakesOutTwentyDecibelsAndMoreAtEveryCamerasRate) {
  for (const double flicker : {100.0, 120.0})
    for (const double rate : {21.0, 24.0, 29.97, 60.0, 59.94, 75.0, 90.0, 144.0}) {
      const Camera camera{rate, 0.002, flicker};
      const auto in = [&](int frame) { return 500 * camera.lamp(frame, 0.3); };
      auto filter = FlickerFilter::create(1, {flicker, rate, 0.002}).value();
      if (filter.harmonics() == 0) continue;  // folds to a constant or nearly
      const auto out = filtered(camera, 200, in);
      std::vector<double> before;
      for (int frame = 0; frame < 200; ++frame) before.push_back(in(frame));
      EXPECT_LT(swing(out, 60), 0.1 * swing(before, 60)) << flicker << " at " << rate;
      EXPECT_NEAR(out.back(), 500, 0.02 * 500) << flicker << " at " << rate;
    }
}

TEST(FlickerFilter, TakesOutASecondHarmonicToo) {
  const Camera camera{21, 0};
  const auto out = filtered(camera, 200, [&](int frame) {
    return camera.lamp(frame, 0.3) + 0.1 * std::cos(4 * kPi * 100 * camera.time(frame));
  });
  EXPECT_LT(swing(out, 60), 0.1 * 0.4);
}

TEST(FlickerFilter, FollowsMainsThatAreOffTheirFrequency) {
  Camera camera;
  camera.flicker_hz = 100.04;  // the European grid's usual deviation, twice
  auto filter = FlickerFilter::create(1, {100, 60, 0.002}).value();
  std::vector<double> out;
  for (int frame = 0; frame < 600; ++frame) {
    std::array<float, 1> value = {static_cast<float>(camera.lamp(frame, 0.3))};
    filter.apply(camera.time(frame), 0.002, value);
    out.push_back(static_cast<double>(value[0]));
  }
  EXPECT_LT(swing(out, 60), 0.1 * 0.28);
}

TEST(FlickerFilter, SteadyLightPassesAsItIs) {
  const auto out = filtered({}, 50, [](int) { return 123.0; });
  for (const double value : out) EXPECT_NEAR(value, 123, 123 * 1e-5);  // floats
}

// Another, steady lamp is switched in the middle of the flicker: the step is there in its own frame.
TEST(FlickerFilter, ASwitchedLampPassesInItsFrameWithoutOvershoot) {
  const Camera camera;
  for (const int at : {60, 61, 62, 77}) {
    for (const double step : {2.0, 0.5, 20.0}) {
      const auto up = filtered(camera, 120,
                               [&](int frame) { return camera.lamp(frame, 0.2) + (frame >= at ? step : 0); });
      const auto down =
          filtered(camera, 120, [&](int frame) { return camera.lamp(frame, 0.2) + (frame < at ? step : 0); });
      for (int frame = at; frame < 120; ++frame) {
        // within 4 % of the step, in the very frame: what the filter may take for the new lamp's swing
        EXPECT_NEAR(up[static_cast<std::size_t>(frame)], 1 + step, 0.04 * step + 0.01) << at << " " << frame;
        EXPECT_NEAR(down[static_cast<std::size_t>(frame)], 1, 0.04 * step + 0.01) << at << " " << frame;
      }
    }
  }
}

// A step of a hundred says nothing of the steps that come seconds later: a small lamp is one again.
TEST(FlickerFilter, ASmallLampLongAfterALargeStepPassesInItsFrame) {
  const Camera camera;
  for (const double depth : {0.0, 0.2})
    for (const double large : {100.0, 1000.0})
      for (const int later : {180, 181, 182, 240}) {
        const auto level = [&](int frame) {
          return frame >= 60 && frame < 90 ? large : frame >= later ? 1.25 : 1.0;
        };
        const auto out = filtered(camera, later + 40,
                                  [&](int frame) { return camera.lamp(frame, depth) + level(frame) - 1; });
        // within 4 % of the lamp, as any other step, and 0.3 % to which powers are trusted
        for (int frame = later; frame < later + 40; ++frame)
          EXPECT_NEAR(out[static_cast<std::size_t>(frame)], level(frame), 0.04 * 0.25 + 0.003)
              << depth << " " << large << " " << later << " " << frame;
      }
}

TEST(FlickerFilter, ALampThatFlickersGoesDarkAtOnceAndComesBackSteady) {
  const Camera camera;
  const auto out = filtered(
      camera, 160, [&](int frame) { return frame >= 60 && frame < 87 ? 0 : 40 * camera.lamp(frame, 0.3); });
  for (std::size_t frame = 60; frame < 87; ++frame) EXPECT_EQ(out[frame], 0) << frame;
  for (std::size_t frame = 87; frame < 160; ++frame)
    EXPECT_NEAR(out[frame], 40, 0.04 * 40) << frame;  // its swing is remembered
}

TEST(FlickerFilter, ANewLampsFlickerIsGoneAfterSixFrames) {
  const Camera camera;
  const auto out =
      filtered(camera, 100, [&](int frame) { return frame < 50 ? 0.0 : camera.lamp(frame, 0.3); });
  for (std::size_t frame = 50; frame < 55; ++frame) EXPECT_NEAR(out[frame], 1, 0.31);
  for (std::size_t frame = 55; frame < 100; ++frame) EXPECT_NEAR(out[frame], 1, 0.03) << frame;
}

// Start-up as any camera sees it under any mains: the rates that fold to nothing, to a third (where three frames
// say all, and a fourth cannot tell an odd one), and to two harmonics.
const std::vector<Camera> kCameras = {
    {25, 0.002, 100}, {25, 0.002, 120}, {30, 0.002, 100}, {30, 0.002, 120},    {50, 0.002, 100},
    {50, 0.002, 120}, {60, 0.002, 100}, {60, 0.002, 120}, {59.94, 0.002, 100}, {59.94, 0.002, 120}};
constexpr double kPhases[] = {0.4, 2.0, 3.5, 5.0};

// At worst everything passes as it is, with its swing.
TEST(FlickerFilter, OneOddFrameMakesNoSwing) {
  for (const Camera& camera : kCameras)
    for (const double depth : {0.0, 0.1, 0.3})
      for (const double odd : {0.0, 0.1, 0.5, 2.0, 10.0})
        for (int at = 0; at < 30; ++at)
          for (const double phase : kPhases) {
            const auto out = filtered(camera, 60, [&](int frame) {
              return camera.lamp(frame, depth, phase) * (frame == at ? odd : 1);
            });
            for (int frame = 0; frame < 60; ++frame) {
              const double seen = frame == at ? odd : 1;
              ASSERT_NEAR(out[static_cast<std::size_t>(frame)], seen, depth * std::max(1.0, seen) + 1e-4)
                  << camera.rate_hz << " Hz, flicker " << camera.flicker_hz << ", depth " << depth
                  << ", times " << odd << " at " << at << ", frame " << frame;
            }
          }
}

TEST(FlickerFilter, FlickerThatIsKnownStaysGoneThroughAnOddFrame) {
  for (const Camera& camera : kCameras) {
    auto filter = FlickerFilter::create(1, {camera.flicker_hz, camera.rate_hz, camera.exposure_s}).value();
    if (filter.harmonics() == 0) continue;
    const int known = static_cast<int>(2 * (1 + 2 * filter.harmonics()));
    for (const double odd : {0.0, 0.5, 2.0, 10.0})
      for (int at = known; at < 30; ++at) {
        const auto out = filtered(
            camera, 80, [&](int frame) { return camera.lamp(frame, 0.3) * (frame == at ? odd : 1); });
        for (int frame = known; frame < 80; ++frame) {
          if (frame == at) continue;
          // of a swing of .28, a tenth: what six or ten frames say about it
          ASSERT_NEAR(out[static_cast<std::size_t>(frame)], 1, 0.03)
              << camera.rate_hz << " Hz, flicker " << camera.flicker_hz << ", times " << odd << " at " << at
              << ", frame " << frame;
        }
      }
  }
}

// A lamp is switched before anything is known, or while it is learnt: it is there in its frame, wholly, and is not
// taken for swing. The lamp that swings, and a steady one.
TEST(FlickerFilter, ALampSwitchedWithinStartUpPassesInItsFrame) {
  for (const Camera& camera : kCameras)
    for (const double step : {-0.3, 0.3, 1.0, 2.0, 20.0})
      for (int at = 1; at < 30; ++at)
        for (const double phase : kPhases) {
          const double rest = std::max(0.0, -step);
          const auto lamp = [&](int frame) { return camera.lamp(frame, 0.3, phase); };
          const auto steady = [&](int frame) { return rest + (frame >= at ? step : 0.0); };
          const auto off = filtered(
              camera, 60, [&](int frame) { return (frame < at ? lamp(frame) : 0) + std::abs(step); });
          const auto both = filtered(camera, 60, [&](int frame) { return lamp(frame) + steady(frame); });
          for (int frame = 0; frame < 60; ++frame) {
            const auto i = static_cast<std::size_t>(frame);
            ASSERT_NEAR(both[i], 1 + steady(frame), 0.3)  // the swing itself, at most
                << camera.rate_hz << " Hz, flicker " << camera.flicker_hz << ", step " << step << " at " << at
                << ", frame " << frame;
            ASSERT_NEAR(off[i], std::abs(step) + (frame < at ? 1 : 0), 0.3)
                << camera.rate_hz << " Hz, flicker " << camera.flicker_hz << ", over " << step << " at " << at
                << ", frame " << frame;
          }
        }
}

TEST(FlickerFilter, ARampIsNotLate) {
  const Camera camera;
  const auto out = filtered(camera, 200, [&](int frame) { return 1 + 0.01 * std::max(0, frame - 80); });
  for (std::size_t frame = 80; frame < 200; ++frame) {
    const double expected = 1 + 0.01 * static_cast<double>(frame - 80);
    EXPECT_NEAR(out[frame], expected, 0.01) << frame;  // within a frame of it
  }
}

TEST(FlickerFilter, NoiseIsNeitherAmplifiedMuchNorTakenForJumps) {
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  const Camera camera;
  double in = 0, out = 0;
  std::vector<double> noisy;
  for (int frame = 0; frame < 1000; ++frame)
    noisy.push_back(100 * (camera.lamp(frame, 0.2) + 0.05 * normal(random)));
  const auto clean =
      filtered(camera, 1000, [&](int frame) { return noisy[static_cast<std::size_t>(frame)]; });
  for (std::size_t frame = 100; frame < 1000; ++frame) {
    in += std::pow(noisy[frame] - 100 * camera.lamp(static_cast<int>(frame), 0.2), 2) / 900;
    out += std::pow(clean[frame] - 100, 2) / 900;
  }
  EXPECT_LT(std::sqrt(out), 1.2 * std::sqrt(in));  // a notch takes noise out, an estimate puts some in
}

// No lamps on the mains: an edge that comes and goes at random. Nothing may come out brighter than what was seen
// within the last frames, nor darker, by more than the little that is taken for swing.
TEST(FlickerFilter, ThingsThatMovePassAsTheyAre) {
  std::mt19937 random(12);
  std::vector<double> in;
  for (int frame = 0; frame < 2000; ++frame) {
    const auto r = random() % 4;
    in.push_back(frame > 0 && r < 2 ? in.back() : 1 + static_cast<double>(random() % 1000));
  }
  const auto out = filtered({}, 2000, [&](int frame) { return in[static_cast<std::size_t>(frame)]; });
  double error = 0, power = 0;
  for (std::size_t frame = 8; frame < in.size(); ++frame) {
    const auto window = in.begin() + static_cast<std::ptrdiff_t>(frame);
    EXPECT_LT(out[frame], 1.5 * *std::max_element(window - 8, window + 1)) << frame;
    error += std::pow(out[frame] - in[frame], 2);
    power += in[frame] * in[frame];
  }
  EXPECT_LT(std::sqrt(error / power), 0.1);
}

TEST(FlickerFilter, FramesMayBeMissingAndTheExposureMayChange) {
  auto filter = FlickerFilter::create(1, {100, 60, 0.002}).value();
  Camera camera;
  for (int frame = 0; frame < 400; ++frame) {
    if (frame % 17 == 5) continue;
    camera.exposure_s = frame < 200 ? 0.002 : 0.006;
    std::array<float, 1> value = {static_cast<float>(camera.lamp(frame, 0.3))};
    filter.apply(camera.time(frame), camera.exposure_s, value);
    if (frame > 60) {
      EXPECT_NEAR(static_cast<double>(value[0]), 1, 0.03) << frame;
    }
  }
}

TEST(FlickerFilter, WhatFoldsToAConstantPassesUntouched) {
  for (const double rate : {25.0, 50.0, 100.0}) {
    auto filter = FlickerFilter::create(2, {100, rate, 0}).value();
    EXPECT_EQ(filter.harmonics(), 0u);
    std::array<float, 2> values = {3, 5};
    filter.apply(0, 0, values);
    EXPECT_EQ(values[1], 5);
  }
  EXPECT_EQ(FlickerFilter::create(1, {100, 60, 0}).value().harmonics(), 1u);  // 200 Hz folds onto 100 Hz
  EXPECT_EQ(FlickerFilter::create(1, {100, 21, 0}).value().harmonics(), 2u);
}

TEST(FlickerFilter, BlackStaysBlackAndNothingComesOutNegativeOrNotANumber) {
  const auto black = filtered({}, 30, [](int) { return 0.0; });
  for (const double value : black) EXPECT_EQ(value, 0);
  std::mt19937 random(3);
  for (const double scale : {1e-30, 1.0, 1e25}) {
    const auto out = filtered({}, 400, [&](int) {
      const auto r = random();
      return r % 5 == 0 ? 0.0 : r % 7 == 0 ? 1e4 * scale : scale * static_cast<double>(r % 1000);
    });
    for (const double value : out) EXPECT_TRUE(std::isfinite(value) && value >= 0);
  }
}

TEST(FlickerFilter, EachPowerIsByItself) {
  const Camera camera;
  auto both = FlickerFilter::create(2, {100, 60, 0.002}).value();
  auto alone = FlickerFilter::create(1, {100, 60, 0.002}).value();
  for (int frame = 0; frame < 50; ++frame) {
    const auto power = static_cast<float>(camera.lamp(frame, 0.3));
    std::array<float, 2> two = {frame == 30 ? 1e6f : 2, power};
    std::array<float, 1> one = {power};
    both.apply(camera.time(frame), 0.002, two);
    alone.apply(camera.time(frame), 0.002, one);
    EXPECT_EQ(two[1], one[0]);
  }
}

TEST(FlickerFilter, AllocatesNothingAFrame) {
  auto filter = FlickerFilter::create(1000, {100, 60, 0.002}).value();
  std::vector<float> powers(1000, 1.0f);
  const test::AllocationCounter counter;
  for (int frame = 0; frame < 5; ++frame) filter.apply(frame / 60.0, 0.002, powers);
  EXPECT_EQ(counter.count(), 0u);
}

TEST(FlickerFilter, OptionsOutOfRangeAreNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(FlickerFilter::create(1, {100, 0, 0}).error().message.find("rate"), std::string::npos);
  EXPECT_NE(FlickerFilter::create(1, {nan, 60, 0}).error().message.find("flicker"), std::string::npos);
  EXPECT_NE(FlickerFilter::create(1, {100, 60, -1}).error().message.find("exposure"), std::string::npos);
}

TEST(DetectFlicker, NamesTheMainsOrNone) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  for (const double flicker : {100.0, 120.0})
    for (const double rate : {21.0, 25.5, 75.0, 90.0}) {
      const Camera camera{rate, 0.002, flicker};
      std::vector<double> powers;
      for (int frame = 0; frame < 64; ++frame)
        powers.push_back(1e4 * (camera.lamp(frame, 0.1) + 0.01 * normal(random) + 0.003 * frame));
      EXPECT_EQ(detect_flicker_hz(powers, rate), flicker) << rate;
    }
  std::vector<double> noise, steady(64, 3.0);
  for (int frame = 0; frame < 64; ++frame) noise.push_back(10 + normal(random));
  EXPECT_FALSE(detect_flicker_hz(noise, 60));
  EXPECT_FALSE(detect_flicker_hz(steady, 60));
  EXPECT_FALSE(detect_flicker_hz(std::vector<double>(64, 0.0), 60));
  EXPECT_FALSE(detect_flicker_hz(noise, 20));  // both fold to 0
}

}  // namespace
}  // namespace lightwell
