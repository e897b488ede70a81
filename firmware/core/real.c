// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/real.h"

#include <stdint.h>

static const float kPi = 3.14159265f;

void turn_sine_cosine(float turns, float* sine, float* cosine) {
  // The nearest quarter turn, and an angle of at most an eighth around it: there Taylor's series needs no more terms.
  const float quarters = turns * 4.0f;
  const int32_t nearest = (int32_t)(quarters < 0.0f ? quarters - 0.5f : quarters + 0.5f);
  const float x = (turns - (float)nearest * 0.25f) * 2.0f * kPi;
  const float xx = x * x;
  const float s =
      x * (1.0f + xx * (-1.0f / 6.0f + xx * (1.0f / 120.0f + xx * (-1.0f / 5040.0f + xx / 362880.0f))));
  const float c = 1.0f + xx * (-0.5f + xx * (1.0f / 24.0f + xx * (-1.0f / 720.0f + xx / 40320.0f)));
  switch ((uint32_t)nearest & 3u) {
    case 0:
      *sine = s;
      *cosine = c;
      break;
    case 1:
      *sine = c;
      *cosine = -s;
      break;
    case 2:
      *sine = -s;
      *cosine = -c;
      break;
    default:
      *sine = -c;
      *cosine = s;
      break;
  }
}

float normalized_sinc(float x) {
  float sine;
  float cosine;
  if (real_magnitude(x) < 1e-4f) return 1.0f;
  turn_sine_cosine(0.5f * x, &sine, &cosine);
  return sine / (kPi * x);
}

// One instruction on a core that has it; a compiler that may set errno would call a library instead.
float real_root(float x) {
  return x > 0.0f ? __builtin_sqrtf(x) : 0.0f;
}
