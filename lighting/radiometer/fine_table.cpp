// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/radiometer/fine_table.h"

#include <cmath>

namespace lightwell::radiometer {
namespace {

constexpr double kError = 1e-4;
constexpr int kMostPerCode = 64;
constexpr double kMostEntries = 1 << 20;

bool fine_enough(const Response& response, double first, double last, int per_code) {
  const double step = 1.0 / per_code;
  for (double code = first; code < last; code += step) {
    const double middle = response.luminance_cd_m2(code + step / 2);
    const double line = (response.luminance_cd_m2(code) + response.luminance_cd_m2(code + step)) / 2;
    const double scale = std::max(std::abs(middle), response.dluminance_dcode(code));
    if (std::abs(line - middle) > kError * scale) return false;
  }
  return true;
}

}  // namespace

FineTable::FineTable(const Response& response, double first_code, double last_code) {
  const double first = std::floor(first_code);
  const double last = std::ceil(last_code);
  int per_code = 1;
  while (per_code < kMostPerCode && 2 * per_code * (last - first) < kMostEntries &&
         !fine_enough(response, first, last, per_code))
    per_code *= 2;
  first_ = static_cast<float>(first);
  per_code_ = static_cast<float>(per_code);
  const auto lines = static_cast<std::size_t>((last - first) * per_code);
  last_ = static_cast<float>(lines);
  table_.reserve(lines + 2);
  // One entry past the end, so that the last code has a line too.
  for (std::size_t i = 0; i < lines + 2; ++i)
    table_.push_back(static_cast<float>(response.luminance_cd_m2(first + static_cast<double>(i) / per_code)));
}

}  // namespace lightwell::radiometer
