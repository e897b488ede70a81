// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Small integer mathematics that C does not have.

#include <stdint.h>

static inline uint32_t clamp_u32(uint32_t value, uint32_t low, uint32_t high) {
  return value < low ? low : value > high ? high : value;
}

static inline int64_t clamp_i64(int64_t value, int64_t low, int64_t high) {
  return value < low ? low : value > high ? high : value;
}

static inline uint64_t magnitude_i64(int64_t value) {
  return value < 0 ? 0u - (uint64_t)value : (uint64_t)value;
}

// Largest integer whose square is not above value, a bit at a time.
static inline uint64_t root_u64(uint64_t value) {
  uint64_t root = 0;
  for (uint64_t bit = (uint64_t)1 << 31; bit > 0u; bit >>= 1)
    if ((root | bit) * (root | bit) <= value) root |= bit;
  return root;
}

static inline uint64_t greatest_common_divisor(uint64_t a, uint64_t b) {
  while (b > 0u) {
    const uint64_t rest = a % b;
    a = b;
    b = rest;
  }
  return a;
}
