// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/gravity.h"

#include "firmware/core/real.h"

static const float kStandard = 9.80665f;  // m/s²
static const float kTimeConstant = 2.0f;  // s: slower than a hand's motion, faster than the bias walks
static const float kRestTime = 0.2f;      // s, once at rest: nothing but noise is left
static const float kBiasTime = 10.0f;     // s
static const float kAccelerated = 0.1f;   // of gravity: more is motion
static const float kTurning = 0.02f;      // rad/s beyond the bias
static const float kLargestBias = 0.05f;  // rad/s: what such gyroscopes promise
static const float kSteadyAfter = 1.0f;   // s

static float length(const float v[3]) {
  return real_root(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

void gravity_init(gravity* self) {
  const gravity nothing = {0};
  *self = nothing;
}

// A vector fixed in the world turns against the board: dv = -rate × v dt. Half the change is taken at either end
// (midpoint rule), so that fast turns do not stretch it.
static void turn(float up[3], const float rate[3], float dt) {
  float middle[3];
  float at[3];
  for (unsigned i = 0; i < 3u; ++i) at[i] = up[i];
  for (unsigned pass = 0; pass < 2u; ++pass) {
    const float* from = pass == 0u ? up : middle;
    const float step = pass == 0u ? 0.5f * dt : dt;
    const float change[3] = {rate[2] * from[1] - rate[1] * from[2], rate[0] * from[2] - rate[2] * from[0],
                             rate[1] * from[0] - rate[0] * from[1]};
    for (unsigned i = 0; i < 3u; ++i) {
      const float value = at[i] + step * change[i];
      if (pass == 0u)
        middle[i] = value;
      else
        at[i] = value;
    }
  }
  for (unsigned i = 0; i < 3u; ++i) up[i] = at[i];
}

static void learn_bias(gravity* self, const float rate[3], float dt) {
  for (unsigned i = 0; i < 3u; ++i) {
    const float bias = self->bias[i] + (rate[i] - self->bias[i]) * dt / kBiasTime;
    self->bias[i] = bias < -kLargestBias ? -kLargestBias : bias > kLargestBias ? kLargestBias : bias;
  }
}

void gravity_sample(gravity* self, const float acceleration[3], const float rate[3], float dt) {
  const float size = length(acceleration);
  if (!self->started) {
    if (size < 0.5f * kStandard) return;
    for (unsigned i = 0; i < 3u; ++i) self->up[i] = acceleration[i];
    self->started = true;
    return;
  }
  const float unbiased[3] = {rate[0] - self->bias[0], rate[1] - self->bias[1], rate[2] - self->bias[2]};
  const bool quiet = real_magnitude(size - kStandard) < kAccelerated * kStandard;
  // Until the bias is known it must not pass for a turn.
  const bool resting = quiet && length(unbiased) < kTurning + kLargestBias - length(self->bias);
  self->rest_s = resting ? self->rest_s + dt : 0.0f;
  turn(self->up, unbiased, dt);
  if (quiet) {
    const float gain = dt / (gravity_steady(self) ? kRestTime : kTimeConstant);
    for (unsigned i = 0; i < 3u; ++i)
      self->up[i] += (acceleration[i] - self->up[i]) * (gain < 1.0f ? gain : 1.0f);
  }
  if (gravity_steady(self)) learn_bias(self, rate, dt);
}

bool gravity_steady(const gravity* self) {
  return self->started && self->rest_s >= kSteadyAfter;
}
