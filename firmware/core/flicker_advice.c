// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/flicker_advice.h"

#include <stdint.h>

#include "firmware/core/real.h"

static const float kGoodEnough = 0.0005f;
// Costs of departing from what is wanted, in beat for a relative change of 1: a frame rate is a production's choice and
// worth ten times an exposure.
static const float kRateCost = 0.02f;
static const float kExposureCost = 0.002f;
static const float kLeastAlias = 0.05f;  // Hz: mains wander; nothing is frozen for good
static const float kMostOfPeriod = 0.9f;
// Neighbours looked at, so that a slow rate under a fast lamp costs no more time than any other: 1 ms of a Cortex-M4.
enum { kRipples = 5, kDivisors = 4 };

float flicker_beat(const flicker_result* light, float rate_hz, float exposure_s) {
  float beat = 0.0f;
  for (unsigned i = 0; i < light->tones; ++i) {
    const float cycles = light->tone[i].hz / rate_hz;
    float alias = real_magnitude(cycles - (float)(int)(cycles + 0.5f)) * rate_hz;
    if (alias < kLeastAlias) alias = kLeastAlias;
    float seen = 1.0f;
    float cosine;
    if (alias < 0.5f)
      turn_sine_cosine(0.5f * alias, &seen, &cosine);  // half a beat in a second shows all of it
    beat +=
        2.0f * light->tone[i].depth * real_magnitude(normalized_sinc(light->tone[i].hz * exposure_s)) * seen;
  }
  return beat;
}

typedef struct {
  const flicker_result* light;
  float wanted_rate, wanted_exposure;
  flicker_advice best;
  float least;
} search;

static void consider(search* self, float rate_hz, float exposure_s) {
  if (exposure_s > kMostOfPeriod / rate_hz || exposure_s < 0.25f * self->wanted_exposure ||
      exposure_s > 4.0f * self->wanted_exposure)
    return;
  const float beat = flicker_beat(self->light, rate_hz, exposure_s);
  const float longer = exposure_s > self->wanted_exposure ? exposure_s / self->wanted_exposure
                                                          : self->wanted_exposure / exposure_s;
  const float cost = (beat > kGoodEnough ? beat : kGoodEnough) +
                     kRateCost * (1.0f - rate_hz / self->wanted_rate) + kExposureCost * (longer - 1.0f);
  if (cost < self->least) {
    self->least = cost;
    self->best = (flicker_advice){rate_hz, exposure_s, beat};
  }
}

static void consider_exposures(search* self, float rate_hz) {
  const float longest = kMostOfPeriod / rate_hz;
  consider(self, rate_hz, self->wanted_exposure < longest ? self->wanted_exposure : longest);
  for (unsigned i = 0; i < self->light->tones; ++i) {
    const float hz = self->light->tone[i].hz;
    const float wanted = hz * (self->wanted_exposure < longest ? self->wanted_exposure : longest);
    const int32_t nearest = (int32_t)(wanted + 0.5f);
    for (int32_t ripples = nearest - kRipples; ripples <= nearest + kRipples; ++ripples)
      if (ripples > 0) consider(self, rate_hz, (float)ripples / hz);
  }
}

flicker_advice flicker_advise(const flicker_result* light, float rate_hz, float exposure_s) {
  search self = {light, rate_hz, exposure_s, {rate_hz, exposure_s, 0.0f}, 3.4e38f};
  self.best.beat = flicker_beat(light, rate_hz, exposure_s);
  consider_exposures(&self, rate_hz);
  for (unsigned i = 0; i < light->tones; ++i) {
    const float hz = light->tone[i].hz;
    const int32_t first = (int32_t)(hz / rate_hz);
    for (int32_t divisor = first; divisor <= first + kDivisors; ++divisor) {
      const float slower = divisor > 0 ? hz / (float)divisor : 0.0f;
      if (slower <= rate_hz && slower >= 0.5f * rate_hz) consider_exposures(&self, slower);
    }
  }
  return self.best;
}
