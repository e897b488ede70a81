// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/fourier.h"

#include "firmware/core/real.h"

enum { kHalf = FOURIER_SIZE / 2 };

static void swap_reversed(float* z) {
  unsigned reversed = 0;
  for (unsigned i = 0; i < (unsigned)kHalf; ++i) {
    if (i < reversed) {
      for (unsigned part = 0; part < 2u; ++part) {
        const float held = z[2u * i + part];
        z[2u * i + part] = z[2u * reversed + part];
        z[2u * reversed + part] = held;
      }
    }
    unsigned bit = (unsigned)kHalf >> 1;
    while ((reversed & bit) != 0u) {
      reversed &= ~bit;
      bit >>= 1;
    }
    reversed |= bit;
  }
}

// Complex, radix 2, decimation in time; a butterfly's factor serves all groups of its stage.
static void complex_transform(float* z) {
  swap_reversed(z);
  for (unsigned span = 1; span < (unsigned)kHalf; span *= 2u) {
    for (unsigned k = 0; k < span; ++k) {
      float sine;
      float cosine;
      turn_sine_cosine(-(float)k / (2.0f * (float)span), &sine, &cosine);
      for (unsigned group = k; group < (unsigned)kHalf; group += 2u * span) {
        float* a = z + 2u * group;
        float* b = a + 2u * span;
        const float real = b[0] * cosine - b[1] * sine;
        const float imaginary = b[0] * sine + b[1] * cosine;
        b[0] = a[0] - real;
        b[1] = a[1] - imaginary;
        a[0] += real;
        a[1] += imaginary;
      }
    }
  }
}

// Even samples are the real parts, odd ones the imaginary parts of half as many complex values; their transforms are
// told apart by symmetry and joined.
void fourier_transform(float values[FOURIER_SIZE]) {
  complex_transform(values);
  const float first = values[0];
  values[0] = first + values[1];
  values[1] = first - values[1];
  for (unsigned k = 1; k <= (unsigned)kHalf / 2u; ++k) {
    float* low = values + 2u * k;
    float* high = values + 2u * ((unsigned)kHalf - k);
    float sine;
    float cosine;
    turn_sine_cosine(-(float)k / (float)FOURIER_SIZE, &sine, &cosine);
    const float even_real = 0.5f * (low[0] + high[0]);
    const float even_imaginary = 0.5f * (low[1] - high[1]);
    const float odd_real = 0.5f * (low[1] + high[1]);
    const float odd_imaginary = 0.5f * (high[0] - low[0]);
    const float turned_real = odd_real * cosine - odd_imaginary * sine;
    const float turned_imaginary = odd_real * sine + odd_imaginary * cosine;
    low[0] = even_real + turned_real;
    low[1] = even_imaginary + turned_imaginary;
    if (low == high) continue;
    high[0] = even_real - turned_real;
    high[1] = turned_imaginary - even_imaginary;
  }
}
