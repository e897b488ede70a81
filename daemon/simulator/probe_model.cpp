// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/simulator/probe_model.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace lightwell::simulator {

Lens default_lens(int width, int height) {
  Lens lens;
  lens.image_size = {width, height};
  lens.center = {(width - 1) / 2.0, (height - 1) / 2.0};
  lens.k = {-0.012, 0.0015, 0, 0};
  lens.max_theta_rad = kPi / 2;
  const double t = lens.max_theta_rad * lens.max_theta_rad;
  const double edge = lens.max_theta_rad * (1 + t * (lens.k[0] + t * lens.k[1]));
  lens.focal = Vec2d::Constant(0.49 * std::min(width, height) / edge);
  return lens;
}

Response default_response(double brightest_cd_m2, int bits) {
  constexpr double kDarkCode = 64,
                   kTopCode = 4000;  // of 4095: room for fixed pattern and noise on both sides
  constexpr double kRange = 1.6e8;
  // Images hold any float; a sensor from 1e-6 to 1e15 cd/m² at the top is wide enough for all that make
  // sense.
  const double top = std::pow(10, std::ceil(std::log10(std::clamp(1.5 * brightest_cd_m2, 1e-6, 1e15))));
  const double c = top / kRange;
  const double b = (kTopCode - kDarkCode) / std::log1p(kRange);
  Response response;
  response.model = LogResponse{kDarkCode - b * std::log(c), b, c};
  response.bits = 12;
  response.black_code = 0;
  response.clip_code = 4095;
  response.reference_exposure_us = 10000;
  return with_bits(response, bits);
}

FlatField default_flat_field(int width, int height, int bits, std::uint64_t seed) {
  constexpr double kColumn_codes = 1.5, kPixel_codes = 2.5;  // of a 12 bit camera
  FlatField flat;
  flat.image_size = {width, height};
  flat.vignetting = {-0.1, -0.02, 0};
  std::mt19937_64 random(seed ^ 0x666c6174);
  // Sums of uniform values: unlike std::normal_distribution the same with every standard library.
  const auto normal = [&] {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += static_cast<double>(random() >> 11) * 0x1p-53;
    return sum;
  };
  std::vector<double> column(static_cast<std::size_t>(width));
  for (double& c : column) c = kColumn_codes * normal();
  const double scale = std::ldexp(1.0, bits - 12);
  flat.offset_codes.reserve(column.size() * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      // In steps of 1/256 code, which a calibration file holds exactly.
      const double offset = column[static_cast<std::size_t>(x)] + kPixel_codes * normal();
      flat.offset_codes.push_back(static_cast<float>(scale * std::round(256 * offset) / 256));
    }
  return flat;
}

}  // namespace lightwell::simulator
