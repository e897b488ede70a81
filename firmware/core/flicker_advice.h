// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Trigger rate and exposure that lamps do not beat with.
//
// A frame of exposure E sees a lamp's ripple of frequency f and depth d with depth d · |sinc(f E)|, from frame to frame
// at the distance of f from the nearest multiple of the rate. E = m / f removes it at any rate; where the exposure must
// be shorter than a ripple, f = k · rate freezes it. What is counted is how much a frame's brightness can change within a
// second.

#include "firmware/core/flicker.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  float rate_hz;
  float exposure_s;
  float beat;  // largest relative change of a frame's brightness within a second
} flicker_advice;

// The same for given settings.
float flicker_beat(const flicker_result* light, float rate_hz, float exposure_s);

// Nearest to the settings wanted (never faster than them, nor slower than half; exposure a quarter of it to four times)
// that beat by less than 0.05 %, or else least. The exposure fits the period with a tenth of it to spare.
flicker_advice flicker_advise(const flicker_result* light, float rate_hz, float exposure_s);

#ifdef __cplusplus
}
#endif
