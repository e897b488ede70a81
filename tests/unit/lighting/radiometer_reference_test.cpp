// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The radiometer against the same in double, for every format, grid, response and instruction set.
#include <gtest/gtest.h>

#include <string>

#include "tests/support/radiometer_checks.h"

namespace lightwell {
namespace {

using test::develop;
using test::expect_equals_reference;
using test::kFormats;
using test::log_camera;
using test::random_codes;
using test::ReferenceMap;
using test::ReferenceRadiometer;

TEST(Radiometer, EveryFormatSizeAndInstructionSetAgreesWithDouble) {
  const PolarGrid grid{45, 120, kPi / 2};
  for (const auto& [pixel_format, bits] : kFormats)
    for (const auto& [width, height] : {std::pair{163, 151}, {33, 64}, {2, 3}}) {
      const FrameFormat format{width, height, pixel_format};
      const Calibration c = log_camera(width, height, bits);
      const auto codes = random_codes(c, format);
      const ReferenceMap reference = ReferenceRadiometer(c, format, grid).develop(codes, 10000);
      for (const Isa isa : available_isas()) {
        SCOPED_TRACE(std::string(name(pixel_format)) + " " + std::to_string(width) + " " +
                     std::string(name(isa)));
        const PolarMap map = develop(c, format, codes, {grid, isa});
        expect_equals_reference(map, reference);
        EXPECT_NEAR(map.coverage, reference.total_sr / (4 * kPi), 1e-6);
      }
    }
}

TEST(Radiometer, LargeBinsAndSegmentsAgreeWithDouble) {
  // Coarse grids make long segments, bins higher than the window (cut into parts) and one bin for everything.
  for (const PolarGrid& grid : {PolarGrid{18, 36, kPi / 2}, PolarGrid{3, 5, kPi / 2},
                                PolarGrid{1, 1, kPi / 2}, PolarGrid{45, 90, 1.2}, PolarGrid{100, 10, 2.0}})
    for (const PixelFormat pixel_format :
         {PixelFormat::mono12p, PixelFormat::mono12, PixelFormat::bayer_rg12}) {
      const FrameFormat format{270, 210, pixel_format};
      const Calibration c = log_camera(270, 210, 12);
      const auto codes = random_codes(c, format);
      const ReferenceMap reference = ReferenceRadiometer(c, format, grid).develop(codes, 10000);
      for (const Isa isa : available_isas()) {
        SCOPED_TRACE(std::to_string(grid.rings) + " " + std::string(name(pixel_format)) + " " +
                     std::string(name(isa)));
        expect_equals_reference(develop(c, format, codes, {grid, isa}), reference);
      }
    }
}

TEST(Radiometer, LinearResponseAgreesWithDouble) {
  for (const PixelFormat pixel_format : {PixelFormat::mono12p, PixelFormat::bayer_rg12}) {
    const FrameFormat format{163, 151, pixel_format};
    Calibration c = log_camera(163, 151, 12);
    c.response = {LinearResponse{64, 0.2}, 12, 64, 4000, 10000};
    const auto codes = random_codes(c, format);
    const ReferenceMap reference = ReferenceRadiometer(c, format, {}).develop(codes, 10000);
    expect_equals_reference(develop(c, format, codes), reference,
                            0.1);  // codes near black cancel: 0.02 codes
  }
}

TEST(Radiometer, LinLogAndCompandedResponsesAgreeWithDouble) {
  struct Case {
    Response response;
    double dark_cd_m2;  // light of 0.02 codes in the first line, where codes near black cancel
  };
  const Case cases[] = {
      {{LinLogResponse{64, 30, 20}, 12, 64, 4000, 10000}, 0.02 / 30},
      // Linear for a hundred codes, then 16 decades.
      {{LinLogResponse{64, 200, 0.5}, 12, 64, 4000, 10000}, 0.02 / 200},
      {{PiecewiseLinearResponse{{{0, 60.3}, {12, 1084.6}, {95, 2108}, {1500, 3132.5}, {24000, 4000.7}}}, 12,
        64, 4000, 10000},
       0.02 * 12 / 1024.3}};
  for (const auto& [response, dark] : cases)
    for (const PixelFormat pixel_format : {PixelFormat::mono12p, PixelFormat::bayer_rg12}) {
      const FrameFormat format{163, 151, pixel_format};
      Calibration c = log_camera(163, 151, 12);
      c.response = response;
      const auto codes = random_codes(c, format);
      const ReferenceMap reference = ReferenceRadiometer(c, format, {}).develop(codes, 10000);
      expect_equals_reference(develop(c, format, codes), reference, dark);
    }
}

TEST(Radiometer, CompandedResponseWithoutFixedPatternAgreesWithDouble) {
  const FrameFormat format{163, 151, PixelFormat::mono12};
  Calibration c = log_camera(163, 151, 12);
  c.flat.offset_codes.clear();
  c.response = {PiecewiseLinearResponse{{{0, 64}, {12, 1084}, {95, 2108}, {24000, 4000}}}, 12, 64, 4000,
                10000};
  const auto codes = random_codes(c, format);
  const ReferenceMap reference = ReferenceRadiometer(c, format, {}).develop(codes, 10000);
  expect_equals_reference(develop(c, format, codes), reference, 0.02 * 12 / 1020);
}

TEST(Radiometer, LogarithmicResponseBeyondTheIntegersAgreesWithDouble) {
  const FrameFormat format{163, 151, PixelFormat::mono12};
  Calibration c = log_camera(163, 151, 12);
  const double b = 4096 / (40 * std::log(2.0));  // 40 octaves: more than 16 bits hold
  c.response.model = LogResponse{10 * b, b, 0};
  const auto codes = random_codes(c, format);
  const ReferenceMap reference = ReferenceRadiometer(c, format, {}).develop(codes, 10000);
  expect_equals_reference(develop(c, format, codes), reference);
}

TEST(Radiometer, ToeIsSubtractedFromEveryPixelAndNeverLeavesLightBelowZero) {
  const FrameFormat format{163, 151, PixelFormat::mono12};
  for (const Isa isa : available_isas()) {
    Calibration c = log_camera(163, 151, 12);
    auto& model = std::get<LogResponse>(c.response.model);
    model.c = 50;
    const auto codes = random_codes(c, format);
    const ReferenceMap reference = ReferenceRadiometer(c, format, {}).develop(codes, 10000);
    // Vignetting enlarges the toe where it enlarges the light, by at most 1 / T(90°) = 1.5.
    expect_equals_reference(develop(c, format, codes, {{}, isa}), reference, 75);
    const std::vector<std::uint16_t> dark(codes.size(), 100);  // ideal radiance below 0
    const PolarMap black = develop(c, format, dark, {{}, isa});
    for (const float v : black.radiance) ASSERT_EQ(v, 0);
    for (const float v : black.peak) ASSERT_EQ(v, 0);
  }
}

TEST(Radiometer, InstructionSetsDifferByTheOrderOfSummationOnly) {
  for (const auto& [pixel_format, bits] : kFormats) {
    const FrameFormat format{111, 97, pixel_format};
    const Calibration c = log_camera(111, 97, bits);
    const auto codes = random_codes(c, format);
    const PolarMap scalar = develop(c, format, codes, {{60, 120, kPi / 2}, Isa::scalar});
    for (const Isa isa : available_isas()) {
      const PolarMap map = develop(c, format, codes, {{60, 120, kPi / 2}, isa});
      for (std::size_t i = 0; i < map.radiance.size(); ++i) {
        // The decoded integers are the same; up to 32 floats are added in another order.
        ASSERT_NEAR(map.radiance[i], scalar.radiance[i], 4e-6f * scalar.radiance[i]) << name(isa);
        ASSERT_NEAR(map.peak[i], scalar.peak[i], 4e-6f * scalar.peak[i]) << name(isa);
      }
      EXPECT_EQ(map.clipped, scalar.clipped);
    }
  }
}

}  // namespace
}  // namespace lightwell
