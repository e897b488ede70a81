// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/luminaire/srgbe.h"

#include <algorithm>
#include <cmath>

namespace lightwell {
namespace {

constexpr int kZero = 128;       // a mantissa's code of 0
constexpr int kSteps = 127;      // codes to each side of it
constexpr int kBias = 126;       // of the exponent
constexpr int kLargest = 129;    // exponent: code 255
constexpr int kSmallest = -126;  // code 0

// Steps of 2^(e − 8): the largest of the three lies between 64 and 128 of them; what rounds to 128 stays at 127, which is
// nearer to it than a neighbour would be with steps twice as wide.
int steps(float value, int exponent) {
  return static_cast<int>(std::lround(std::ldexp(static_cast<double>(value), 8 - exponent)));
}

}  // namespace

Srgbe to_srgbe(const Rgb& value) noexcept {
  Rgb known = value;
  for (float& v : known) v = std::isnan(v) ? 0.0f : std::clamp(v, -0x1.fcp+127f, 0x1.fcp+127f);
  const float largest = known.abs().maxCoeff();
  if (!(largest > 0)) return {};
  const int exponent = std::clamp(std::ilogb(largest) + 2, kSmallest, kLargest);
  Srgbe code;
  for (Eigen::Index i = 0; i < 3; ++i)
    code.mantissa[static_cast<std::size_t>(i)] =
        static_cast<std::uint8_t>(kZero + std::clamp(steps(known[i], exponent), -kSteps, kSteps));
  code.exponent = static_cast<std::uint8_t>(exponent + kBias);
  return code;
}

Rgb from_srgbe(const Srgbe& code) noexcept {
  Rgb value;
  for (Eigen::Index i = 0; i < 3; ++i)
    value[i] = std::ldexp(static_cast<float>(code.mantissa[static_cast<std::size_t>(i)] - kZero),
                          code.exponent - kBias - 8);
  return value;
}

}  // namespace lightwell
