// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Where a rate's edges lie in board time: edge number index + i is at base + i · period. Fractions of a tick have 32
// bits, so a second of edges is exact to far below a tick.

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  uint64_t index;        // of the edge at base
  uint64_t base;         // ticks
  uint32_t base_part;    // and 2^-32 ticks
  uint32_t period_part;  // 2^-32 ticks
  uint32_t period;       // ticks
} timeline;

// tick_hz · denominator / numerator ticks an edge; the rate is at least 1 Hz and numerator below 2^31.
void timeline_init(timeline* self, uint64_t base, uint32_t tick_hz, uint32_t numerator, uint32_t denominator);

// Tick of the place index + rest / parts of an edge, rounded to the nearest. rest < parts < 2^30.
// Exact where the period is a whole number of ticks: nothing accumulates.
uint64_t timeline_tick(const timeline* self, uint64_t index, uint32_t rest, uint32_t parts);

// Moves index and base so that base <= now < base + period. Changes no edge by as much as a tick.
void timeline_roll(timeline* self, uint64_t now);

uint64_t timeline_period_q32(const timeline* self);
void timeline_set_period_q32(timeline* self, uint64_t period_q32);

// base += change · 2^-32 ticks
void timeline_shift_q32(timeline* self, int64_t change_q32);

#ifdef __cplusplus
}
#endif
