// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "daemon/simulator/probe_model.h"
#include "daemon/simulator/scene.h"
#include "lighting/lat_long_image.h"

namespace lightwell::test {

using simulator::ProbeModel;
using simulator::Scene;

inline ProbeModel probe(const Scene& scene, int width, int height, PixelFormat format, double noise) {
  ProbeModel model;
  const int bits = significant_bits(format);
  model.format = {width, height, format};
  model.calibration.lens = simulator::default_lens(width, height);
  model.calibration.response = simulator::default_response(scene.brightest_cd_m2(), bits);
  model.calibration.flat = simulator::default_flat_field(width, height, bits, 1);
  model.noise_codes = noise;
  model.seed = 1;
  return model;
}

inline unsigned code_at(std::span<const std::byte> bytes, PixelFormat format, std::size_t i) {
  const auto b = [&](std::size_t k) { return std::to_integer<unsigned>(bytes[k]); };
  if (storage_bits(format) == 8) return b(i);
  if (storage_bits(format) == 16) return b(2 * i) | b(2 * i + 1) << 8;
  const std::size_t k = i / 2 * 3;
  return i % 2 == 0 ? b(k) | (b(k + 1) & 15) << 8 : b(k + 1) >> 4 | b(k + 2) << 4;
}

// What the default lens makes of every pixel. Exact solid angles take microseconds each, and every case of a test asks
// for the same ones.
struct PixelGeometry {
  double solid_angle_sr, theta_rad;
};

inline const std::vector<PixelGeometry>& default_geometry(int width, int height) {
  static std::map<std::pair<int, int>, std::vector<PixelGeometry>> known;
  std::vector<PixelGeometry>& pixels = known[{width, height}];
  if (pixels.empty()) {
    const Lens lens = simulator::default_lens(width, height);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        pixels.push_back(
            {lens.pixel_solid_angle_sr({x, y}), std::min(lens.theta_rad({x, y}), lens.max_theta_rad)});
  }
  return pixels;
}

// The calibration read back to front in double, pixel by pixel: an independent, slow decoder.
inline Rgbd decoded_illuminance(const ProbeModel& model, std::span<const std::byte> bytes,
                                double exposure_us) {
  const Calibration& c = model.calibration;
  const bool bayer = is_bayer(model.format.pixel_format);
  const std::vector<PixelGeometry>& geometry = default_geometry(model.format.width, model.format.height);
  Rgbd sum = Rgbd::Zero();
  std::size_t i = 0;
  for (int y = 0; y < model.format.height; ++y)
    for (int x = 0; x < model.format.width; ++x, ++i) {
      const auto& [omega, theta] = geometry[i];
      if (omega <= 0) continue;
      const double code =
          code_at(bytes, model.format.pixel_format, i) - static_cast<double>(c.flat.offset_codes[i]);
      const double radiance = c.response.luminance_cd_m2(code) * c.response.reference_exposure_us /
                              exposure_us / c.flat.transmission(theta);
      if (!bayer)
        sum += radiance * omega;
      else
        sum[(x & 1) + (y & 1)] += radiance * omega * (((x ^ y) & 1) != 0 ? 2 : 4);
    }
  return sum;
}

inline LatLongImage black_image(int width, int height) {
  return {width, height,
          std::vector<Rgb>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), Rgb::Zero())};
}

inline void expect_close(const Rgbd& got, const Rgbd& want, double relative, const std::string& what) {
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(got[c], want[c], relative * want[c] + 1e-12) << what << ", channel " << c;
}

}  // namespace lightwell::test
