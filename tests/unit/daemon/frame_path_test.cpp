// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/frame_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

namespace lightwell {
namespace {

constexpr FrameFormat kFormat{64, 64, PixelFormat::mono12};
constexpr double kRate_hz = 60;

Calibration calibration() {
  Calibration made;
  made.response.model = LogResponse{1000, 150, 0};
  made.lens.image_size = {64, 64};
  made.lens.center = {31.5, 31.5};
  made.lens.focal = {32 / (kPi / 2), 32 / (kPi / 2)};
  return made;
}

// A uniform scene whose lamp swings at 100 Hz by 30 %, with a lamp three times as bright switched on at `switched`:
// total luminance of the lights, frame by frame.
std::vector<double> totals(double flicker_hz, int frames, int switched, double known_rate_hz = kRate_hz) {
  FramePathOptions options;
  options.radiometer.grid = {10, 40, kPi / 2};
  options.lights.count = 30;
  options.lights.clusters = 0;
  options.lights.filter = TemporalFilter::none;
  options.flicker_hz = flicker_hz;
  SnapshotChannel snapshots{FramePath::prototype(options)};
  FramePath path(calibration(), options, snapshots);
  EXPECT_TRUE(path.prepare(kFormat, known_rate_hz));
  std::vector<std::byte> codes(kFormat.bytes());
  std::vector<double> list;
  for (int frame = 0; frame < frames; ++frame) {
    FrameInfo info;
    info.format = kFormat;
    info.sequence = static_cast<std::uint64_t>(frame);
    info.exposure_us = 10000;  // the response's reference: radiance is as the code says
    info.capture_mono_ns = 5'000'000'000 + static_cast<std::int64_t>(frame * 1e9 / kRate_hz);
    const double seconds = static_cast<double>(info.capture_mono_ns) * 1e-9;
    const double radiance =
        100 * (1 + 0.3 * std::cos(2 * kPi * 100 * seconds)) + (frame >= switched ? 300 : 0);
    const auto code = static_cast<std::uint16_t>(std::lround(1000 + 150 * std::log(radiance)));
    for (std::size_t i = 0; i + 1 < codes.size(); i += 2) std::memcpy(&codes[i], &code, 2);
    path.process(info, codes);
    const auto snapshot = snapshots.wait_newer(static_cast<std::uint64_t>(frame), std::chrono::seconds(20));
    list.push_back(static_cast<double>(luminance(snapshot->total_illuminance)));
  }
  return list;
}

double swing(const std::vector<double>& values, std::size_t from, std::size_t to) {
  const auto [least, largest] = std::minmax_element(values.begin() + static_cast<std::ptrdiff_t>(from),
                                                    values.begin() + static_cast<std::ptrdiff_t>(to));
  return (*largest - *least) / 2;
}

TEST(FramePath, MainsFlickerIsTakenOutOfTheMapAndASwitchedLampPasses) {
  const auto flickering = totals(0, 60, 40);
  const auto steady = totals(100, 60, 40);
  const double level = (flickering[12] + flickering[13] + flickering[14]) / 3;  // a period
  EXPECT_GT(swing(flickering, 12, 40), 0.2 * level);
  EXPECT_LT(swing(steady, 12, 40), 0.02 * level);  // codes are 0.7 % apart
  EXPECT_NEAR(steady[40] / level, 4, 0.15);        // in its very frame, within what may be taken for swing
  for (std::size_t frame = 45; frame < 60; ++frame) EXPECT_NEAR(steady[frame] / level, 4, 0.04) << frame;
}

TEST(FramePath, WithoutARateFlickerIsLeftIn) {
  EXPECT_EQ(totals(100, 20, 10, 0), totals(0, 20, 10, 0));
}

}  // namespace
}  // namespace lightwell
