// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/temperature.h"

enum { kColdest = -60000, kHottest = 150000, kMemory = 8 };

int32_t temperature_of_tmp105(uint16_t reading) {
  const int32_t sixteenths = (int32_t)(reading >> 4) - ((reading & 0x8000u) != 0u ? 4096 : 0);
  return sixteenths * 125 / 2;
}

int32_t temperature_of_stm32(uint32_t code, uint32_t code_at_30, uint32_t code_at_110) {
  const int32_t span = (int32_t)code_at_110 - (int32_t)code_at_30;
  if (span <= 0) return INT32_MAX;  // no calibration there: out of every range
  return 30000 + (int32_t)((int64_t)80000 * ((int32_t)code - (int32_t)code_at_30) / span);
}

void temperature_init(temperature* self) {
  self->started = false;
  self->count = 0;
}

static int32_t middle(int32_t a, int32_t b, int32_t c) {
  if (a > b) {
    const int32_t held = a;
    a = b;
    b = held;
  }
  return c < a ? a : c > b ? b : c;
}

bool temperature_sample(temperature* self, int32_t reading_mc, int32_t* filtered_mc) {
  if (reading_mc >= kColdest && reading_mc <= kHottest) {
    self->recent[self->count % 3u] = reading_mc;
    ++self->count;
    if (self->count == 6u) self->count = 3u;  // only whether three have come, and the place, matter
    const int32_t median_q8 = 256 * middle(self->recent[0], self->recent[1], self->recent[2]);
    if (self->count >= 3u && !self->started) {
      self->started = true;
      self->value_q8 = median_q8;
    } else if (self->started) {
      self->value_q8 += (median_q8 - self->value_q8) / kMemory;
    }
  }
  if (self->count < 3u) return false;
  *filtered_mc = (self->value_q8 + (self->value_q8 < 0 ? -128 : 128)) / 256;
  return true;
}
