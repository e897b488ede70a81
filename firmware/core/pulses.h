// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The trigger train: which timeline it follows, what has been given to the hardware, and what came of it.

#include <stdbool.h>
#include <stdint.h>

#include "firmware/core/servo.h"
#include "firmware/core/trigger.h"
#include "interface/sync_protocol.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { PULSES_AHEAD = 2 };  // in the hardware's hands: one armed, one waiting

typedef struct {
  uint32_t n;
  uint64_t tick;
  int32_t phase_ns;
  uint16_t flags;
} pulse;

typedef struct {
  uint32_t tick_hz;
  timeline own;  // our clock, an edge a second
  servo reference;
  uint32_t epoch;  // of the reference that is followed
  trigger next;
  uint32_t length;  // of a pulse, ticks
  bool running, skipped;
  uint32_t rate_numerator, rate_denominator, reference_numerator, reference_denominator;
  pulse ahead[PULSES_AHEAD];
  unsigned first, count;
  uint32_t sent, missed;
} pulses;

void pulses_init(pulses* self, uint32_t tick_hz, uint64_t now);

// Begins anew with these settings, which are valid.
void pulses_configure(pulses* self, const sync_configuration* settings, uint64_t now);

// Call a few times a period.
void pulses_advance(pulses* self, uint64_t now);

// The next pulse for the hardware; false: none now. It lasts self->length.
bool pulses_take(pulses* self, uint64_t now, pulse* taken);

// The oldest pulse taken has been made, or its time was missed: *done. False: there is none.
bool pulses_done(pulses* self, bool made, pulse* done);

#ifdef __cplusplus
}
#endif
