// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/radiometer/log_tables.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace lightwell::radiometer {
namespace {

constexpr double kTop = 65535;

std::uint32_t steps_of(const LogCurve& curve, double code) {
  return (static_cast<std::uint32_t>(code) << curve.shift) * curve.slope >> 16;
}

// Mean of what truncation takes from the product: its fractions are the multiples of 1/q.
double mean_truncation(const LogCurve& curve) {
  const std::uint32_t per_code = static_cast<std::uint32_t>(curve.slope) << curve.shift;
  const double q = 65536.0 / std::gcd(per_code, 65536u);
  return (q - 1) / (2 * q);
}

}  // namespace

std::optional<LogTables> fold_log_response(const Response& response, const SampleWeights& weights) {
  const auto* model = std::get_if<LogResponse>(&response.model);
  if (model == nullptr) return std::nullopt;
  const double octaves_per_code = 1 / (model->b * std::log(2.0));
  const double slope = std::round(kOctave * octaves_per_code * std::ldexp(1.0, response.bits));
  if (!(slope >= 1 && slope <= kTop)) return std::nullopt;
  LogTables out;
  out.curve.clip = static_cast<std::uint16_t>(std::ceil(response.clip_code));
  out.curve.shift = 16 - response.bits;
  out.curve.slope = static_cast<std::uint16_t>(slope);
  out.curve.base = static_cast<std::uint16_t>(kTop - steps_of(out.curve, out.curve.clip));

  std::vector<float> gain(weights.weight_sr.size());  // octaves
  std::vector<float> most;                            // of each group
  for (std::size_t i = 0; i < gain.size(); ++i) {
    if (!(weights.weight_sr[i] > 0)) continue;
    gain[i] = static_cast<float>(std::log2(static_cast<double>(weights.weight_sr[i])) -
                                 octaves_per_code * static_cast<double>(weights.offset_codes[i]));
    if (weights.group[i] >= most.size())
      most.resize(weights.group[i] + 1, -std::numeric_limits<float>::infinity());
    most[weights.group[i]] = std::max(most[weights.group[i]], gain[i]);
  }
  // The slope's rounding and the truncation are made to vanish on average in the middle of the codes. One
  // step is added so that no attenuation has to be negative; the unit takes it back.
  const double middle = (response.black_code + response.clip_code) / 2;
  const double exact_step = kOctave * octaves_per_code;
  const double integer_step = slope * std::ldexp(1.0, out.curve.shift) / 65536;
  const double bias = 1 + middle * (integer_step - exact_step) - mean_truncation(out.curve);

  const double room = out.curve.base + steps_of(out.curve, response.black_code);
  std::size_t inside = 0;
  std::size_t too_dark = 0;
  out.attenuation.assign(gain.size(), static_cast<std::uint16_t>(kTop));
  for (std::size_t i = 0; i < gain.size(); ++i) {
    if (!(weights.weight_sr[i] > 0)) continue;
    const double below = static_cast<double>(most[weights.group[i]]) - static_cast<double>(gain[i]);
    const double steps = std::round(kOctave * below + bias);
    out.attenuation[i] = static_cast<std::uint16_t>(std::clamp(steps, 0.0, kTop));
    ++inside;
    if (steps > room) ++too_dark;
  }
  // A pixel may fall below the bottom at the darkest codes only if it counts for little: slivers that the
  // border leaves, dead pixels. One in a hundred at most.
  if (100 * too_dark > inside) return std::nullopt;
  for (const float octaves : most)
    out.unit.push_back(std::exp2(16 - (out.curve.base - 1.0) / kOctave + static_cast<double>(octaves) -
                                 octaves_per_code * model->a));
  return out;
}

}  // namespace lightwell::radiometer
