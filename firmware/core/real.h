// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The single-precision mathematics that the board needs; the image links no mathematics library.

#ifdef __cplusplus
extern "C" {
#endif

// Sine and cosine of an angle in turns, within 2e-7 for angles below a thousand turns.
void turn_sine_cosine(float turns, float* sine, float* cosine);

// sin(pi x) / (pi x)
float normalized_sinc(float x);

// Square root; 0 of what is negative.
float real_root(float x);

static inline float real_magnitude(float x) {
  return x < 0.0f ? -x : x;
}

#ifdef __cplusplus
}
#endif
