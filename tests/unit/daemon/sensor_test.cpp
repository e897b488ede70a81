// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/simulator/sensor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "daemon/simulator/frame_generator.h"
#include "tests/support/simulated_frames.h"

namespace lightwell::simulator {
namespace {

using test::code_at;
using test::probe;

TEST(Sensor, CodesAreTheResponseRoundedToTheNearest) {
  ProbeModel model;
  model.format = {256, 16, PixelFormat::mono12};
  model.calibration.lens = default_lens(256, 16);
  model.calibration.response = default_response(1e6, 12);
  model.noise_codes = 0;
  Sensor sensor(model);
  std::vector<float> plane(256 * 16);
  for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = std::exp(static_cast<float>(i) / 150 - 10);
  plane[0] = 0;
  std::vector<std::byte> frame(model.format.bytes());
  sensor.encode(plane, 10000, 0, PixelFormat::mono12, frame);
  for (std::size_t i = 0; i < plane.size(); ++i) {
    const double ideal =
        std::clamp(model.calibration.response.code(static_cast<double>(plane[i])), 0.0, 4095.0);
    EXPECT_NEAR(code_at(frame, PixelFormat::mono12, i), ideal,
                0.502);  // rounding, and 2e-3 of float arithmetic
  }
}

TEST(Sensor, FormatsHoldTheSameLightAtTheirOwnDepth) {
  const auto scene = make_studio_scene(false);
  for (const PixelFormat format :
       {PixelFormat::mono8, PixelFormat::mono10, PixelFormat::mono12p, PixelFormat::mono16}) {
    const ProbeModel model = probe(*scene, 160, 120, PixelFormat::mono12, 0);
    FrameGenerator generator(scene, model);
    std::vector<std::byte> reference(model.format.bytes());
    generator.render(0, 10000, 0, PixelFormat::mono12, reference);
    FrameFormat other = model.format;
    other.pixel_format = format;
    std::vector<std::byte> frame(other.bytes());
    generator.render(0, 10000, 0, format, frame);
    const double scale = std::ldexp(1.0, significant_bits(format) - 12);
    for (std::size_t i = 0; i < 160 * 120; ++i)
      EXPECT_NEAR(code_at(frame, format, i), code_at(reference, PixelFormat::mono12, i) * scale,
                  0.51 + 0.51 * scale);
  }
}

TEST(Sensor, PacksTwelveBitsLeastSignificantFirst) {
  const std::uint16_t codes[4] = {0xabc, 0x123, 0xfff, 0x001};
  std::byte out[6];
  pack_codes(codes, PixelFormat::mono12p, out);
  const unsigned expected[6] = {0xbc, 0x3a, 0x12, 0xff, 0x1f, 0x00};
  for (int i = 0; i < 6; ++i) EXPECT_EQ(std::to_integer<unsigned>(out[i]), expected[i]);
}

TEST(Sensor, NoiseHasTheStatedSpreadAndFollowsTheSeed) {
  const auto scene = make_studio_scene(false);
  ProbeModel model = probe(*scene, 160, 120, PixelFormat::mono16, 0);
  const auto frame_of = [&](double noise, std::uint64_t seed, std::uint64_t index) {
    model.noise_codes = noise;
    model.seed = seed;
    FrameGenerator generator(scene, model);
    std::vector<std::byte> frame(model.format.bytes());
    generator.render(0, 10000, index, PixelFormat::mono16, frame);
    return frame;
  };
  const auto clean = frame_of(0, 1, 0), noisy = frame_of(2, 1, 0);
  EXPECT_EQ(noisy, frame_of(2, 1, 0));
  EXPECT_NE(noisy, frame_of(2, 2, 0));
  EXPECT_NE(noisy, frame_of(2, 1, 1));
  EXPECT_EQ(clean, frame_of(0, 2, 5));
  double sum = 0, square = 0;
  const std::size_t n = 160 * 120;
  for (std::size_t i = 0; i < n; ++i) {
    const double d = (static_cast<double>(code_at(noisy, PixelFormat::mono16, i)) -
                      code_at(clean, PixelFormat::mono16, i)) /
                     16;
    sum += d;
    square += d * d;
  }
  const double mean = sum / static_cast<double>(n);
  EXPECT_NEAR(mean, 0, 5 * 2 / std::sqrt(n));  // five standard errors
  EXPECT_NEAR(std::sqrt(square / static_cast<double>(n) - mean * mean), 2, 5 * 2 / std::sqrt(2.0 * n));
}

TEST(ProbeModel, CalibrationIsValidAtEveryDepthAndSize) {
  for (const int bits : {8, 10, 12, 16})
    for (const double brightest : {0.0, 1e-3, 7e5, 2e9, 1e30}) {
      const Response response = default_response(brightest, bits);
      EXPECT_TRUE(check(response)) << bits << " " << brightest;
      if (brightest > 0 && brightest < 1e15) {
        EXPECT_LT(response.code(brightest), response.clip_code);
      }
    }
  for (const auto& [width, height] : {std::pair(1, 1), {640, 480}, {31, 17}, {1024, 1024}}) {
    const Lens lens = default_lens(width, height);
    EXPECT_TRUE(check(lens));
    EXPECT_TRUE(check(default_flat_field(width, height, 12, 1), lens));
  }
}

}  // namespace
}  // namespace lightwell::simulator
