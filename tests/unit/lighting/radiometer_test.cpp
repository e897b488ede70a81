// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/radiometer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/support/radiometer_checks.h"

namespace lightwell {
namespace {

using test::develop;
using test::expect_equals_reference;
using test::kFormats;
using test::kKernelError;
using test::log_camera;
using test::pack;
using test::random_codes;
using test::ReferenceMap;
using test::ReferenceRadiometer;

constexpr double kEnergyError = 1e-3;

double illuminance(const PolarMap& map, int channel) {
  double sum = 0;
  for (std::size_t b = 0; b < map.grid.size(); ++b)
    sum += static_cast<double>(map.plane(channel)[b]) * static_cast<double>(map.solid_angle_sr[b]);
  return sum;
}

// Codes of a constant radiance, in double and rounded: the code's rounding is what differs from pixel to
// pixel.
TEST(Radiometer, ConstantRadianceGivesAConstantMap) {
  for (const PixelFormat pixel_format : {PixelFormat::mono16, PixelFormat::bayer_rg16}) {
    const FrameFormat format{201, 200, pixel_format};
    Calibration c = log_camera(201, 200, 16);
    c.lens.max_theta_rad = 80 * kPi / 180;
    const double radiance = 321;
    std::vector<std::uint16_t> codes;
    for (int y = 0; y < 200; ++y)
      for (int x = 0; x < 201; ++x) {
        const double t = c.flat.transmission(std::min(c.lens.theta_rad(Vec2d(x, y)), c.lens.max_theta_rad));
        const double offset = static_cast<double>(c.flat.offset_codes[codes.size()]);
        codes.push_back(static_cast<std::uint16_t>(std::lround(c.response.code(radiance * t) + offset)));
      }
    for (const Isa isa : available_isas()) {
      const PolarMap map = develop(c, format, codes, {{}, isa});
      // Half a code of 16 bits over 26 octaves is 1.4e-4, beside the kernel's own error. Bins beyond the
      // lens's field carry their nearest pixel's.
      for (const float v : map.radiance) ASSERT_NEAR(v / radiance, 1, kKernelError + 1.4e-4);
      // A peak is that of the largest pixel of the bin: exact where all are whole.
      for (std::size_t b = 0; b < map.grid.size(); ++b)
        if (map.grid.ring_edge_rad(static_cast<int>(b) / 360) < 70 * kPi / 180) {
          ASSERT_NEAR(map.peak[b] / radiance, 1, kKernelError + 1.4e-4);
        }
    }
  }
}

// Pixels where a sun is hardest to keep: pole, seam, horizon on each side, a border pixel, anywhere.
std::vector<std::pair<int, int>> hard_places(const Calibration& c) {
  const auto& size = c.lens.image_size;
  const int cx = static_cast<int>(std::lround(c.lens.center.x()));
  const int cy = static_cast<int>(std::lround(c.lens.center.y()));
  std::vector<std::pair<int, int>> places = {
      {cx, cy}, {cx - 1, cy}, {cx, cy - 40}, {cx - 1, cy - 40}, {cx + 31, cy + 17}};
  for (int x = 0; x < size[0]; ++x)  // the horizon along the middle row: whole and cut pixels
    if (const double theta = c.lens.theta_rad(Vec2d(x, cy)); theta > 1.53 && theta < 1.59)
      places.emplace_back(x, cy);
  return places;
}

TEST(Radiometer, OnePixelSunKeepsItsEnergyWhereverItStands) {
  const FrameFormat format{320, 240, PixelFormat::mono12};
  const Calibration c = log_camera(320, 240, 12);
  const ReferenceRadiometer reference(c, format, {});
  for (const Isa isa : available_isas()) {
    auto radiometer = Radiometer::create(c, format, {{}, isa});
    ASSERT_TRUE(radiometer);
    PolarMap map = radiometer->make_map();
    int cut_pixels = 0;
    for (const auto& [x, y] : hard_places(c)) {
      std::vector<std::uint16_t> codes(320 * 240, 300);
      radiometer->develop(pack(codes, format), 10000, map);
      const double before = illuminance(map, 0);
      codes[static_cast<std::size_t>(y * 320 + x)] = 4000;  // 2^23 times the rest
      radiometer->develop(pack(codes, format), 10000, map);
      const double expected = reference.pixel_radiance(codes, x, y) * reference.solid_angle_sr(x, y);
      EXPECT_NEAR((illuminance(map, 0) - before), expected, kEnergyError * expected) << x << " " << y;
      if (expected == 0) continue;
      if (reference.solid_angle_sr(x, y) < 0.9 * reference.solid_angle_sr(160, 120) * 0.6) ++cut_pixels;
      EXPECT_NEAR(illuminance(map, 0) / reference.develop(codes, 10000).energy[0], 1, kEnergyError);
    }
    EXPECT_GT(cut_pixels, 0);  // the border was among the places
  }
}

TEST(Radiometer, OnePixelSunOnAnyColourOfTheMosaicKeepsWhatThatColourMeasured) {
  const FrameFormat format{321, 241, PixelFormat::bayer_rg12};
  const Calibration c = log_camera(321, 241, 12);
  const ReferenceRadiometer reference(c, format, {});
  for (const Isa isa : available_isas()) {
    auto radiometer = Radiometer::create(c, format, {{}, isa});
    ASSERT_TRUE(radiometer);
    PolarMap map = radiometer->make_map();
    for (const auto& [x, y] :
         {std::pair{160, 120}, {161, 120}, {160, 121}, {161, 121}, {200, 31}, {99, 201}}) {
      std::vector<std::uint16_t> codes(321 * 241, 300);
      codes[static_cast<std::size_t>(y * 321 + x)] = 4000;
      radiometer->develop(pack(codes, format), 10000, map);
      const auto expected = reference.develop(codes, 10000).energy;
      for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(illuminance(map, channel) / expected[static_cast<std::size_t>(channel)], 1, kEnergyError);
    }
  }
}

TEST(Radiometer, ColoursGoThroughTheMatrix) {
  const FrameFormat format{160, 160, PixelFormat::bayer_rg12};
  Calibration c = log_camera(160, 160, 12);
  const auto codes = random_codes(c, format);
  const PolarMap plain = develop(c, format, codes);
  c.rec709_from_camera << 1.6, -0.4, -0.2, -0.3, 1.5, -0.2, 0.1, -0.5, 1.4;
  const PolarMap map = develop(c, format, codes);
  for (std::size_t b = 0; b < map.grid.size(); ++b) {
    const Eigen::Vector3d camera = plain.rgb(b).matrix().cast<double>();
    const Eigen::Vector3d expected = (c.rec709_from_camera * camera).cwiseMax(0.0);
    ASSERT_LT((map.rgb(b).matrix().cast<double>() - expected).norm(), 1e-5 * camera.norm());  // float
  }
}

TEST(Radiometer, RadianceScalesWithTheInverseOfTheExposure) {
  const FrameFormat format{64, 64, PixelFormat::mono12};
  const Calibration c = log_camera(64, 64, 12);
  const auto codes = random_codes(c, format);
  const PolarMap one = develop(c, format, codes, {}, 10000);
  const PolarMap four = develop(c, format, codes, {}, 2500);
  for (std::size_t b = 0; b < one.radiance.size(); ++b) {
    ASSERT_EQ(four.radiance[b], 4 * one.radiance[b]);  // a power of two is exact
    ASSERT_EQ(four.peak[b], 4 * one.peak[b]);
  }
}

TEST(Radiometer, PeakIsTheBrightestPixelOfTheBin) {
  const FrameFormat format{320, 320, PixelFormat::mono12};
  const Calibration c = log_camera(320, 320, 12);
  const auto codes = random_codes(c, format);
  const PolarGrid grid{45, 90, kPi / 2};
  const ReferenceMap reference = ReferenceRadiometer(c, format, grid).develop(codes, 10000);
  const PolarMap map = develop(c, format, codes, {grid, {}});
  for (std::size_t b = 0; b < 44 * 90; ++b)  // all but the ring that the border cuts
    if (reference.solid_angle_sr[b] >
        0) {  // pixels of a bin of 2 degrees differ by up to 2.5 % in solid angle
      ASSERT_NEAR(static_cast<double>(map.peak[b]) / reference.peak[0][b], 1, 0.026) << b;
    }
}

TEST(Radiometer, EmptyBinsCarryTheirNearestPixelAndNoSolidAngle) {
  const FrameFormat format{40, 40, PixelFormat::mono12};
  const Calibration c = log_camera(40, 40, 12);
  const auto codes = random_codes(c, format);
  const PolarMap map = develop(c, format, codes);
  const ReferenceRadiometer reference(c, format, {});
  std::size_t empty = 0;
  for (std::size_t b = 0; b < map.grid.size(); ++b) {
    ASSERT_GT(map.radiance[b], 0);
    if (map.solid_angle_sr[b] > 0) continue;
    ++empty;
    ASSERT_EQ(map.clipped[b], 0);
    const int ring = static_cast<int>(b) / 360;
    const Vec3d direction = camera_from_world(map.grid.bin_direction(ring, static_cast<int>(b) % 360));
    double nearest = -1;
    std::vector<double> candidates;  // radiance of the pixels that are nearest, ties within rounding
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x) {
        if (reference.solid_angle_sr(x, y) < 1e-12) continue;
        const double cosine = c.lens.unproject(Vec2d(x, y)).dot(direction);
        if (cosine > nearest + 1e-12) candidates.clear();
        if (cosine < nearest - 1e-12) continue;
        nearest = std::max(nearest, cosine);
        candidates.push_back(reference.pixel_radiance(codes, x, y));
      }
    double best = 1;
    for (const double v : candidates)
      best = std::min(best, std::abs(static_cast<double>(map.radiance[b]) / v - 1));
    ASSERT_LT(best, kKernelError) << b;
    if (empty == 40) break;  // the reference is slow, and rings are alike
  }
  EXPECT_GT(empty, 0u);
}

TEST(Radiometer, OnePixelSeesTheWholeHemisphere) {
  for (const PixelFormat pixel_format : {PixelFormat::mono8, PixelFormat::mono12p, PixelFormat::mono16}) {
    const FrameFormat format{1, 1, pixel_format};
    Calibration c = log_camera(1, 1,
                               pixel_format == PixelFormat::mono8    ? 8
                               : pixel_format == PixelFormat::mono16 ? 16
                                                                     : 12);
    c.lens.focal = {0.2, 0.2};  // the circle lies inside the pixel
    c.lens.center = {0, 0};
    c.flat = {};
    const auto code = static_cast<std::uint16_t>(c.response.clip_code / 2);
    for (const Isa isa : available_isas()) {
      const PolarMap map = develop(c, format, {code}, {{}, isa});
      const double expected = c.response.luminance_cd_m2(code);
      for (const float v : map.radiance) ASSERT_NEAR(v / expected, 1, kKernelError);
      EXPECT_NEAR(illuminance(map, 0) / (expected * 2 * kPi), 1, kEnergyError);
      EXPECT_NEAR(map.coverage, 0.5, 1e-6);
    }
  }
}

TEST(Radiometer, AFieldWiderThanTheImageMeasuresOnlyWhatTheImageSees) {
  const FrameFormat format{200, 100, PixelFormat::mono12};
  Calibration c = log_camera(200, 100, 12);
  c.lens.focal = {80, 80};  // the circle is cut above and below
  c.lens.center = {60, 10};
  const auto codes = random_codes(c, format);
  const ReferenceMap reference = ReferenceRadiometer(c, format, {}).develop(codes, 10000);
  const PolarMap map = develop(c, format, codes);
  expect_equals_reference(map, reference);
  EXPECT_LT(map.coverage, 0.4);
  for (const float v : map.radiance) ASSERT_GT(v, 0);
}

TEST(Radiometer, AllBlackAllClippedAndImpossibleCodesStayFiniteAndCounted) {
  for (const auto& [pixel_format, bits] : kFormats)
    for (const Isa isa : available_isas()) {
      const FrameFormat format{97, 96, pixel_format};
      const Calibration c = log_camera(97, 96, bits);
      const auto top = static_cast<std::uint16_t>((1 << storage_bits(pixel_format)) - 1);
      const auto clip = static_cast<std::uint16_t>(c.response.clip_code);
      const PolarMap at_clip =
          develop(c, format, std::vector<std::uint16_t>(97 * 96, clip), {{30, 60, kPi / 2}, isa});
      for (const std::uint16_t code : {std::uint16_t{0}, clip, top}) {
        const PolarMap map =
            develop(c, format, std::vector<std::uint16_t>(97 * 96, code), {{30, 60, kPi / 2}, isa});
        std::uint32_t sum = 0;
        for (const auto n : map.clipped) sum += n;
        EXPECT_EQ(sum, map.clipped_pixels);
        EXPECT_EQ(map.clipped_pixels > 0, code >= clip);
        for (std::size_t i = 0; i < map.radiance.size(); ++i) {
          ASSERT_TRUE(std::isfinite(map.radiance[i]) && map.radiance[i] >= 0);
          ASSERT_TRUE(std::isfinite(map.peak[i]) && map.peak[i] >= 0);
          if (code >= clip) {  // codes above count as the clip code
            ASSERT_EQ(map.radiance[i], at_clip.radiance[i]);
          }
        }
      }
    }
}

TEST(Radiometer, AFrameFollowsAnotherWithoutTrace) {
  const FrameFormat format{320, 240, PixelFormat::mono12p};
  const Calibration c = log_camera(320, 240, 12);
  auto radiometer = Radiometer::create(c, format, {});
  ASSERT_TRUE(radiometer);
  PolarMap map = radiometer->make_map();
  radiometer->develop(pack(std::vector<std::uint16_t>(320 * 240, 4095), format), 10000, map);
  const auto codes = random_codes(c, format);
  radiometer->develop(pack(codes, format), 10000, map);
  const PolarMap fresh = develop(c, format, codes);
  EXPECT_EQ(map.radiance, fresh.radiance);
  EXPECT_EQ(map.peak, fresh.peak);
  EXPECT_EQ(map.clipped, fresh.clipped);
  EXPECT_EQ(map.clipped_pixels, fresh.clipped_pixels);
}

TEST(Radiometer, ForcedInstructionSetIsUsedAndAnAbsentOneRefused) {
  const FrameFormat format{64, 64, PixelFormat::mono12};
  const Calibration c = log_camera(64, 64, 12);
  const auto available = available_isas();
  ASSERT_EQ(std::count(available.begin(), available.end(), Isa::scalar), 1);
  EXPECT_EQ(Radiometer::create(c, format, {})->isa(), available.front());
  int refused = 0;
  for (const Isa isa : {Isa::scalar, Isa::simd128, Isa::avx2, Isa::neon}) {
    const auto radiometer = Radiometer::create(c, format, {{}, isa});
    if (std::count(available.begin(), available.end(), isa) == 1) {
      ASSERT_TRUE(radiometer);
      EXPECT_EQ(radiometer->isa(), isa);
    } else {
      ASSERT_FALSE(radiometer);
      EXPECT_EQ(radiometer.error().kind, ErrorKind::usage);
      EXPECT_NE(radiometer.error().message.find(std::string(name(isa))), std::string::npos);
      ++refused;
    }
  }
  EXPECT_GE(refused, 1);  // no machine has both AVX2 and NEON
}

void expect_refused(const Calibration& c, const FrameFormat& format, const RadiometerOptions& options,
                    const std::string& start) {
  const auto radiometer = Radiometer::create(c, format, options);
  ASSERT_FALSE(radiometer) << start;
  EXPECT_EQ(radiometer.error().kind, ErrorKind::bad_input);
  EXPECT_EQ(radiometer.error().message.substr(0, start.size()), start);
}

TEST(Radiometer, CreateNamesWhatDisagrees) {
  const Calibration c = log_camera(64, 48, 12);
  const FrameFormat good{64, 48, PixelFormat::mono12};
  expect_refused(c, {65, 48, PixelFormat::mono12}, {}, "frame width = 65: allowed 64");
  expect_refused(c, {64, 47, PixelFormat::mono12}, {}, "frame height = 47: allowed 48");
  expect_refused(c, {64, 48, PixelFormat::mono10}, {}, "response.bits = 12: allowed 10");
  expect_refused(c, {64, 48, PixelFormat::mono8}, {}, "response.bits = 12: allowed 8");
  expect_refused(log_camera(64, 48, 10), good, {}, "response.bits = 10: allowed 12");
  expect_refused(log_camera(64, 48, 8), {64, 48, PixelFormat::mono16}, {},
                 "response.bits = 8: allowed 10 to 16");
  EXPECT_TRUE(Radiometer::create(c, {64, 48, PixelFormat::mono16}, {}));
  expect_refused(c, good, {PolarGrid{0, 360, 1}, {}}, "map rings = 0");
  expect_refused(c, good, {PolarGrid{90, 360, 4}, {}}, "map theta_max_rad = 4");
  Calibration away = c;
  away.lens.center = {-500, 20};
  expect_refused(away, good, {}, "lens.center");
  Calibration thin = log_camera(1, 48, 12);
  expect_refused(thin, {1, 48, PixelFormat::bayer_rg12}, {}, "frame size of a Bayer mosaic = 1");
}

TEST(RadiometerDeathTest, WrongSpansAreBugs) {
  const FrameFormat format{64, 48, PixelFormat::mono12};
  auto radiometer = Radiometer::create(log_camera(64, 48, 12), format, {});
  ASSERT_TRUE(radiometer);
  PolarMap map = radiometer->make_map();
  const std::vector<std::byte> frame(format.bytes());
  EXPECT_DEATH(radiometer->develop(std::span(frame).first(frame.size() - 1), 10000, map),
               "bug: develop: frame");
  EXPECT_DEATH(radiometer->develop(frame, 0, map), "bug: develop: exposure");
  PolarMap other = PolarMap::make({10, 10, 1}, 1);
  EXPECT_DEATH(radiometer->develop(frame, 10000, other), "bug: develop: map");
}

}  // namespace
}  // namespace lightwell
