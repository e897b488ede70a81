// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// When the next trigger is due. Trigger k lies at k · step reference periods on a timeline, step being an exact
// fraction: at 24000/1001 Hz no error accumulates, and a reference that drifts takes the triggers along. The hardware
// makes the edge by output compare; what is decided here only ever moves the next one, by a sixteenth of a period at
// the most.

#include <stdbool.h>
#include <stdint.h>

#include "firmware/core/timeline.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  uint64_t step;   // reference periods a trigger, in parts; never 0
  uint32_t parts;  // below 2^30
  uint64_t index;  // place of the next trigger: index + rest / parts
  uint32_t rest;
  int64_t phase_ticks;  // after that place
  uint32_t period;      // nominal, ticks
  uint64_t next;        // tick of the next trigger
  int64_t phase_error;  // next less where it should be: not 0 while slewing
  uint32_t n;           // of the next trigger
  uint32_t late;        // left out
} trigger;

// rate: triggers a second; reference: edges of the timeline a second. False: their ratio needs more than 30 bits.
bool trigger_ratio(uint32_t rate_numerator, uint32_t rate_denominator, uint32_t reference_numerator,
                   uint32_t reference_denominator, uint64_t* step, uint32_t* parts);

// Keeps n and late. The first trigger is the first place at or after earliest.
void trigger_start(trigger* self, const timeline* line, uint64_t step, uint32_t parts, uint32_t period,
                   int64_t phase_ticks, uint64_t earliest);

// Goes over to another timeline: the next trigger takes the place nearest to it there, and gets there slewing.
void trigger_move(trigger* self, const timeline* line, uint64_t step, uint32_t parts);

// The next one has been fired: next, n and phase_error become those of its successor.
void trigger_fired(trigger* self, const timeline* line);

// Leaves out, and counts, what is due before earliest. True: some were.
bool trigger_skip(trigger* self, const timeline* line, uint64_t earliest);

#ifdef __cplusplus
}
#endif
