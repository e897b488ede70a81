// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "lighting/vector.h"

namespace lightwell {

// Three signed numbers in four bytes: mantissas that share an exponent.
// source: Granier et al. 2003, section 4.2 and appendix A, repaired: the mantissas' zero is a code of its own (128), so that
// 0, ±2^k and changes of sign are exact; nothing overflows, and 0 is no NaN. Error at most 1/128 of the largest of the three.
struct Srgbe {
  std::array<std::uint8_t, 3> mantissa = {128, 128, 128};  // 1 to 255
  std::uint8_t exponent = 0;
};

// NaN becomes 0, what is beyond the range ±(127/128) 2^128 its end. Below 2^-126 the error is at most 2^-135.
Srgbe to_srgbe(const Rgb& value) noexcept;
Rgb from_srgbe(const Srgbe& code) noexcept;

}  // namespace lightwell
