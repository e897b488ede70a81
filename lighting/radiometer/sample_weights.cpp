// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/radiometer/sample_weights.h"

#include <algorithm>

namespace lightwell::radiometer {
namespace {

struct Pixel {
  double weight_sr = 0;
  float offset_codes = 0;
};

// Pixel (x, y) standing for omega.
Pixel weigh(const Calibration& calibration, int x, int y, double omega) {
  const Lens& lens = calibration.lens;
  const FlatField& flat = calibration.flat;
  Pixel pixel{omega, 0};
  if (flat.vignetting !=
      std::array<double, 3>{0, 0, 0})  // a border pixel's centre may lie just past the field
    pixel.weight_sr /= flat.transmission(std::min(lens.theta_rad(Vec2d(x, y)), lens.max_theta_rad));
  const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(lens.image_size[0]) +
                  static_cast<std::size_t>(x);
  if (!flat.gain.empty()) pixel.weight_sr /= static_cast<double>(flat.gain[at]);
  if (!flat.offset_codes.empty()) pixel.offset_codes = flat.offset_codes[at];
  return pixel;
}

}  // namespace

SampleWeights weigh_samples(const Calibration& calibration, const PixelBins& bins, const CellPlan& plan,
                            bool bayer) {
  const std::size_t per_sample = bayer ? 4 : 1;
  SampleWeights out;
  out.weight_sr.assign(plan.rows.size() * plan.stride * per_sample, 0);
  out.offset_codes = out.weight_sr;
  out.group.assign(out.weight_sr.size(), kNone);
  for (auto& sums : out.bin_weight_sr) sums.assign(bins.bin_sr.size(), 0);
  const auto put = [&](std::size_t at, const Pixel& pixel, std::size_t channel, std::uint32_t group) {
    out.weight_sr[at] = static_cast<float>(pixel.weight_sr);
    out.offset_codes[at] = pixel.offset_codes;
    out.group[at] = group;
    out.bin_weight_sr[channel][bins.bin_of_group[group]] += pixel.weight_sr;
  };
  std::size_t sample = 0;
  for (int y = 0; y < bins.height; ++y)
    for (int x = 0; x < bins.width; ++x, ++sample) {
      const std::uint32_t group = bins.group[sample];
      if (group == kNone) continue;
      const auto column = static_cast<std::size_t>(x - plan.first_column);
      const auto omega = static_cast<double>(bins.solid_angle_sr[sample]);
      if (!bayer) {
        put(static_cast<std::size_t>(y) * plan.stride + column, weigh(calibration, x, y, omega), 0, group);
        continue;
      }
      for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
          const auto channel = static_cast<std::size_t>(i + j);  // RGGB
          const std::size_t at =
              (2 * static_cast<std::size_t>(y) + static_cast<std::size_t>(j)) * 2 * plan.stride + 2 * column +
              static_cast<std::size_t>(i);
          const Pixel pixel = weigh(calibration, source_pixel(2 * x + i, calibration.lens.image_size[0]),
                                    source_pixel(2 * y + j, calibration.lens.image_size[1]),
                                    channel == 1 ? omega / 2 : omega);
          put(at, pixel, channel, group);
        }
    }
  return out;
}

}  // namespace lightwell::radiometer
