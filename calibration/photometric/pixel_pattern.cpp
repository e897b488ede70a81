// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/pixel_pattern.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "lighting/median.h"

namespace lightwell::calibration {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kLargestLnGain =
    0.69;  // half to twice; beyond, the pixel is dead and its gain means nothing

double slope_of(const Response& response, double luminance) {  // dcode / dln L
  const double per_code = response.dluminance_dcode(response.code(luminance));
  return per_code > 0 ? luminance / per_code : 0;
}

struct Estimate {
  double offset = 0, ln_gain = 0, sigma = kNever;  // of ln_gain
};

double mean_residual(const std::vector<PixelReading>& readings, const Response& response) {
  double sum = 0, weight = 0;
  for (const PixelReading& r : readings) {
    const double w = 1 / (r.sigma_code * r.sigma_code);
    sum += w * (r.code - response.code(r.luminance_cd_m2));
    weight += w;
  }
  return weight > 0 ? sum / weight : 0;
}

Estimate with_gain(const std::vector<PixelReading>& readings, const Response& response) {
  Estimate e;
  for (int round = 0; round < 3; ++round) {  // linear in one of the two, nearly so in the other
    double w1 = 0, ws = 0, wss = 0, wr = 0, wsr = 0;
    for (const PixelReading& r : readings) {
      const double luminance = r.luminance_cd_m2 * std::exp(e.ln_gain);
      const double w = 1 / (r.sigma_code * r.sigma_code), s = slope_of(response, luminance);
      const double residual = r.code - response.code(luminance);
      w1 += w;
      ws += w * s;
      wss += w * s * s;
      wr += w * residual;
      wsr += w * s * residual;
    }
    const double determinant = w1 * wss - ws * ws;
    if (!(determinant > 1e-9 * w1 * wss)) return {};
    e.ln_gain = std::clamp(e.ln_gain + (w1 * wsr - ws * wr) / determinant, -kLargestLnGain, kLargestLnGain);
    double shared = 0;  // as if the takes erred each against the others
    for (const PixelReading& r : readings) {
      const double w = 1 / (r.sigma_code * r.sigma_code);
      const double s = slope_of(response, r.luminance_cd_m2 * std::exp(e.ln_gain));
      shared += std::abs(w * (w1 * s - ws) / determinant) * r.shared_sigma_code;
    }
    e.sigma = std::hypot(std::sqrt(w1 / determinant), shared);
    e.offset = (wr - (w1 * wsr - ws * wr) / determinant * ws) / w1;
  }
  return e;
}

}  // namespace

PixelPattern fit_pattern(const std::vector<std::vector<PixelReading>>& readings, const Response& response) {
  std::vector<Estimate> estimates(readings.size());
  std::vector<double> sizes, noise;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    if (readings[i].size() < 2) continue;
    estimates[i] = with_gain(readings[i], response);
    if (!std::isfinite(estimates[i].sigma)) continue;
    sizes.push_back(std::abs(estimates[i].ln_gain));
    noise.push_back(estimates[i].sigma);
  }
  PixelPattern out;
  out.offset_codes.assign(readings.size(), 0);
  // A gain for a few pixels only would be no flat field.
  std::size_t read = 0;
  for (const auto& r : readings) read += !r.empty();
  out.gain_sigma = 2 * noise.size() > read ? median(std::move(noise), kNever) : kNever;
  out.gain_rms = std::isfinite(out.gain_sigma) ? 1.4826 * median(std::move(sizes)) : 0;  // robust
  const bool supported = out.gain_rms * out.gain_rms > 2 * out.gain_sigma * out.gain_sigma;
  if (supported) out.gain.assign(readings.size(), 1);
  for (std::size_t i = 0; i < readings.size(); ++i) {
    if (readings[i].empty()) continue;
    if (supported && std::isfinite(estimates[i].sigma)) {
      out.gain[i] = static_cast<float>(std::exp(estimates[i].ln_gain));
      out.offset_codes[i] = static_cast<float>(estimates[i].offset);
    } else {
      out.offset_codes[i] = static_cast<float>(mean_residual(readings[i], response));
    }
  }
  return out;
}

}  // namespace lightwell::calibration
