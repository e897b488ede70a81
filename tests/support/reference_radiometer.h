// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lighting/calibration.h"
#include "lighting/direction.h"
#include "lighting/frame_format.h"
#include "lighting/polar_map.h"

// The radiometer once more, one pixel after the other in double, from the definitions alone. Slow, for tests
// and for the error column of the bench.
namespace lightwell::test {

struct ReferenceMap {
  std::array<std::vector<double>, 3>
      radiance;  // camera colours, toe subtracted, not clamped; NaN where no pixel is
  std::array<std::vector<double>, 3> peak;  // largest pixel radiance
  std::vector<double> solid_angle_sr;
  std::array<double, 3> energy = {0, 0, 0};  // Σ pixel radiance × solid angle
  std::vector<std::uint32_t> clipped;
  double total_sr = 0;
};

class ReferenceRadiometer {
 public:
  ReferenceRadiometer(const Calibration& calibration, const FrameFormat& format, const PolarGrid& grid)
      : calibration_(calibration), format_(format), grid_(grid) {
    Lens lens = calibration.lens;
    lens.max_theta_rad = std::min(lens.max_theta_rad, grid.theta_max_rad);
    for (int y = 0; y < format.height; ++y)
      for (int x = 0; x < format.width; ++x) sr_.push_back(lens.pixel_solid_angle_sr(Vec2d(x, y)));
  }

  [[nodiscard]] ReferenceMap develop(const std::vector<std::uint16_t>& codes, double exposure_us) const {
    ReferenceMap map;
    for (auto* planes : {&map.radiance, &map.peak})
      for (auto& plane : *planes) plane.assign(grid_.size(), 0);
    map.solid_angle_sr.assign(grid_.size(), 0);
    map.clipped.assign(grid_.size(), 0);
    const int step = is_bayer(format_.pixel_format) ? 2 : 1;
    for (int y = 0; y < format_.height; y += step)
      for (int x = 0; x < format_.width; x += step)
        step == 1 ? add_pixel(codes, x, y, map) : add_quad(codes, x, y, map);
    for (auto& plane : map.radiance)
      for (std::size_t b = 0; b < plane.size(); ++b) plane[b] /= map.solid_angle_sr[b];
    const double scale = calibration_.response.reference_exposure_us / exposure_us;
    for (std::size_t c = 0; c < 3; ++c) {
      map.energy[c] *= scale;
      for (double& v : map.radiance[c]) v *= scale;
      for (double& v : map.peak[c]) v *= scale;
    }
    return map;
  }

  // Radiance of one pixel at the reference exposure; x, y may lie past an odd border: then its colour's pixel
  // before.
  [[nodiscard]] double pixel_radiance(const std::vector<std::uint16_t>& codes, int x, int y) const {
    const std::size_t i = index(x < format_.width ? x : x - 2, y < format_.height ? y : y - 2);
    const double clip = std::ceil(calibration_.response.clip_code);
    double code = std::min<double>(codes[i], clip);
    if (!calibration_.flat.offset_codes.empty())
      code -= static_cast<double>(calibration_.flat.offset_codes[i]);
    const Vec2d at(static_cast<double>(i % static_cast<std::size_t>(format_.width)),
                   static_cast<double>(i / static_cast<std::size_t>(format_.width)));
    const double theta = std::min(calibration_.lens.theta_rad(at), calibration_.lens.max_theta_rad);
    return calibration_.response.luminance_cd_m2(code) / calibration_.flat.transmission(theta);
  }
  [[nodiscard]] double solid_angle_sr(int x, int y) const { return sr_[index(x, y)]; }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(format_.width) +
           static_cast<std::size_t>(x);
  }
  [[nodiscard]] std::size_t bin_at(const Vec2d& pixel) const {
    const Spherical s = spherical_from_direction(world_from_camera(calibration_.lens.unproject(pixel)));
    const auto ring = std::min(static_cast<std::size_t>(grid_.rings - 1),
                               static_cast<std::size_t>(s.theta_rad / grid_.theta_max_rad * grid_.rings));
    const auto sector = std::min(static_cast<std::size_t>(grid_.sectors - 1),
                                 static_cast<std::size_t>(s.lambda_rad / (2 * kPi) * grid_.sectors));
    return ring * static_cast<std::size_t>(grid_.sectors) + sector;
  }
  void add(ReferenceMap& map, std::size_t channel, std::size_t bin, double radiance, double sr) const {
    map.radiance[channel][bin] += radiance * sr;
    map.peak[channel][bin] = std::max(map.peak[channel][bin], radiance);
    map.energy[channel] += radiance * sr;
  }
  void count(ReferenceMap& map, const std::vector<std::uint16_t>& codes, int x, int y,
             std::size_t bin) const {
    if (x < format_.width && y < format_.height && codes[index(x, y)] >= calibration_.response.clip_code)
      ++map.clipped[bin];
  }
  void add_pixel(const std::vector<std::uint16_t>& codes, int x, int y, ReferenceMap& map) const {
    const double sr = sr_[index(x, y)];
    if (!(sr > 1e-12)) return;
    const std::size_t bin = bin_at(Vec2d(x, y));
    map.solid_angle_sr[bin] += sr;
    map.total_sr += sr;
    add(map, 0, bin, pixel_radiance(codes, x, y), sr);
    count(map, codes, x, y, bin);
  }
  void add_quad(const std::vector<std::uint16_t>& codes, int x, int y, ReferenceMap& map) const {
    const int right = std::min(x + 1, format_.width - 1);
    const int bottom = std::min(y + 1, format_.height - 1);
    double sr = 0;
    for (int v = y; v <= bottom; ++v)
      for (int u = x; u <= right; ++u) sr += sr_[index(u, v)];
    if (!(sr > 1e-12)) return;
    const std::size_t bin = bin_at(Vec2d((x + right) / 2.0, (y + bottom) / 2.0));
    map.solid_angle_sr[bin] += sr;
    map.total_sr += sr;
    const double green = (pixel_radiance(codes, x + 1, y) + pixel_radiance(codes, x, y + 1)) / 2;
    add(map, 0, bin, pixel_radiance(codes, x, y), sr);
    add(map, 1, bin, green, sr);
    add(map, 2, bin, pixel_radiance(codes, x + 1, y + 1), sr);
    for (int v = y; v < y + 2; ++v)
      for (int u = x; u < x + 2; ++u) count(map, codes, u, v, bin);
  }

  Calibration calibration_;
  FrameFormat format_;
  PolarGrid grid_;
  std::vector<double> sr_;
};

// Codes as the camera would send them.
inline std::vector<std::byte> pack(const std::vector<std::uint16_t>& codes, const FrameFormat& format) {
  std::vector<std::byte> bytes(format.bytes());
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const std::uint32_t code = codes[i];
    const auto byte = [](std::uint32_t v) { return static_cast<std::byte>(v & 255); };
    switch (storage_bits(format.pixel_format)) {
      case 8:
        bytes[i] = byte(code);
        break;
      case 16:
        bytes[2 * i] = byte(code);
        bytes[2 * i + 1] = byte(code >> 8);
        break;
      default: {  // 12 bits, low bits first
        const std::size_t bit = 12 * i;
        const std::uint32_t shifted = code << bit % 8;
        bytes[bit / 8] |= byte(shifted);
        bytes[bit / 8 + 1] |= byte(shifted >> 8);
      }
    }
  }
  return bytes;
}

}  // namespace lightwell::test
