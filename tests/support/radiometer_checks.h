// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "lighting/radiometer.h"
#include "tests/support/log_camera.h"
#include "tests/support/reference_radiometer.h"

namespace lightwell::test {

// The bound against double, from the kernel's own budget of 4.4e-4
// (lighting/radiometer/log_tables.h).
inline constexpr double kKernelError = 5e-4;

inline PolarMap develop(const Calibration& c, const FrameFormat& format,
                        const std::vector<std::uint16_t>& codes, const RadiometerOptions& options = {},
                        double exposure_us = 10000) {
  auto radiometer = Radiometer::create(c, format, options);
  if (!radiometer) {
    ADD_FAILURE() << radiometer.error().message;
    return {};
  }
  // Exactly the frame's bytes at an odd address: reading past it shows under the address sanitizer.
  const auto frame = pack(codes, format);
  std::vector<std::byte> odd(frame.size() + 1);
  std::copy(frame.begin(), frame.end(), odd.begin() + 1);
  PolarMap map = radiometer->make_map();
  radiometer->develop(std::span(odd).subspan(1), exposure_us, map);
  return map;
}

// Every measured bin within kKernelError of the reference, relative to radiance with its toe.
inline void expect_equals_reference(const PolarMap& map, const ReferenceMap& reference, double toe = 0) {
  const std::size_t n = map.grid.size();
  double worst = 0;
  for (std::size_t b = 0; b < n; ++b) {
    ASSERT_NEAR(static_cast<double>(map.solid_angle_sr[b]), reference.solid_angle_sr[b],
                1e-6 * reference.solid_angle_sr[b] + 1e-15);  // float rounding
    ASSERT_EQ(map.clipped[b], reference.clipped[b]) << b;
    if (reference.solid_angle_sr[b] == 0) continue;
    for (std::size_t c = 0; c < static_cast<std::size_t>(map.channels); ++c) {
      const double expected = std::max(0.0, reference.radiance[c][b]);
      const double error = std::abs(static_cast<double>(map.radiance[c * n + b]) - expected);
      worst = std::max(worst, error / (expected + toe));
      ASSERT_GE(map.peak[c * n + b], map.radiance[c * n + b]);
    }
  }
  EXPECT_LT(worst, kKernelError);
}

struct FormatCase {
  PixelFormat format;
  int bits;
};
inline const std::vector<FormatCase> kFormats = {
    {PixelFormat::mono8, 8},      {PixelFormat::mono10, 10},     {PixelFormat::mono12, 12},
    {PixelFormat::mono12p, 12},   {PixelFormat::mono16, 16},     {PixelFormat::mono16, 14},
    {PixelFormat::bayer_rg8, 8},  {PixelFormat::bayer_rg10, 10}, {PixelFormat::bayer_rg12, 12},
    {PixelFormat::bayer_rg16, 16}};

}  // namespace lightwell::test
