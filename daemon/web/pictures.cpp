// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/web/pictures.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lightwell {
namespace {

// Global tone reproduction, Reinhard et al. 2002: scaled luminance a L, burnt out at white².
struct Exposure {
  float scale = 1;
  float white_squared = 1;

  [[nodiscard]] float display(float luminance_cd_m2) const {
    const float x = luminance_cd_m2 * scale;
    return x * (1 + x / white_squared) / (1 + x);
  }
};

Exposure expose(const PolarMap& map) {
  std::vector<float> values(map.grid.size());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = luminance(map.rgb(i));
  const float peak = *std::max_element(values.begin(), values.end());
  if (!(peak > 0)) return {};
  // Log average (equation 1); six decades below the peak count as black, so that zeros do not decide.
  double sum = 0;
  for (const float v : values) sum += std::log(static_cast<double>(v) + 1e-6 * static_cast<double>(peak));
  const auto scale = static_cast<float>(0.18 / std::exp(sum / static_cast<double>(values.size())));
  // All but the brightest hundredth (the sun) stay below white; never below 4, which keeps dull skies from
  // glaring.
  const auto near_top = values.begin() + static_cast<std::ptrdiff_t>(values.size() - 1 - values.size() / 100);
  std::nth_element(values.begin(), near_top, values.end());
  const float white = std::max(4.0f, *near_top * scale);
  return {scale, white * white};
}

// sRGB encoding (IEC 61966-2-1) of 0 to 1 in 4096 steps, fine enough for 8 bits but the darkest.
std::uint8_t encode(float linear) {
  static const auto table = [] {
    std::array<std::uint8_t, 4097> t{};
    for (std::size_t i = 0; i < t.size(); ++i) {
      const double x = static_cast<double>(i) / 4096;
      const double y = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
      t[i] = static_cast<std::uint8_t>(std::lround(255 * y));
    }
    return t;
  }();
  return table[static_cast<std::size_t>(std::clamp(linear, 0.0f, 1.0f) * 4096)];
}

// Bilinear between bin centres; wraps in azimuth, and ends at the first and last ring.
Rgb sample(const PolarMap& map, float theta, float azimuth) {
  const PolarGrid& grid = map.grid;
  const float r =
      std::clamp(theta / static_cast<float>(grid.theta_max_rad) * static_cast<float>(grid.rings) - 0.5f, 0.0f,
                 static_cast<float>(grid.rings - 1));
  const float s = azimuth / static_cast<float>(2 * kPi) * static_cast<float>(grid.sectors) - 0.5f +
                  static_cast<float>(grid.sectors);
  const int r0 = static_cast<int>(r);
  const int r1 = std::min(r0 + 1, grid.rings - 1);
  const int s0 = static_cast<int>(s);
  const float fr = r - static_cast<float>(r0);
  const float fs = s - static_cast<float>(s0);
  const auto at = [&](int ring, int sector) {
    return map.rgb(static_cast<std::size_t>(ring * grid.sectors + sector % grid.sectors));
  };
  const Rgb inner = at(r0, s0) * (1 - fs) + at(r0, s0 + 1) * fs;
  const Rgb outer = at(r1, s0) * (1 - fs) + at(r1, s0 + 1) * fs;
  return inner * (1 - fr) + outer * fr;
}

}  // namespace

std::vector<std::uint8_t> fisheye_picture(const PolarMap& map, int size) {
  const Exposure exposure = expose(map);
  std::vector<std::uint8_t> picture(static_cast<std::size_t>(size) * static_cast<std::size_t>(size) * 3);
  const float radius = static_cast<float>(size) / 2;
  auto pixel = picture.begin();
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x, pixel += 3) {
      const float right = static_cast<float>(x) + 0.5f - radius;
      const float up = radius - (static_cast<float>(y) + 0.5f);
      const float r = std::hypot(right, up) / radius;
      if (r > 1) continue;
      float azimuth = std::atan2(right, up);
      if (azimuth < 0) azimuth += static_cast<float>(2 * kPi);
      const Rgb radiance = sample(map, r * static_cast<float>(map.grid.theta_max_rad), azimuth);
      const float l = luminance(radiance);
      if (!(l > 0)) continue;
      const float gain = exposure.display(l) / l;
      for (int c = 0; c < 3; ++c) pixel[c] = encode(radiance[c] * gain);
    }
  return picture;
}

}  // namespace lightwell
