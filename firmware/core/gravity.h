// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Which way is up, by a complementary filter: the gyroscope carries the vector through motion, the accelerometer draws it
// back slowly, and only where what it reads can be gravity. At rest the gyroscope's bias is learned.
// Source: Mahony, Hamel and Pflimlin 2008, "Nonlinear Complementary Filters on the Special Orthogonal Group", on the
// vector alone: azimuth has no reference here and is left out.

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  float up[3];    // as an accelerometer at rest reads it, m/s²; board axes
  float bias[3];  // of the gyroscope, rad/s
  bool started;
  float rest_s;  // for how long the board has been at rest
} gravity;

void gravity_init(gravity* self);

// acceleration: m/s²; rate: rad/s, both in board axes; dt: seconds since the last sample, at most 0.1.
void gravity_sample(gravity* self, const float acceleration[3], const float rate[3], float dt);

// At rest for a second: up is trustworthy.
bool gravity_steady(const gravity* self);

#ifdef __cplusplus
}
#endif
