// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// 64-bit board time in ticks out of a 32-bit timer (84 MHz: it wraps every 51 s), and what a tick is in nanoseconds.

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  uint64_t now;  // ticks at the last update
} board_time;

void board_time_init(board_time* self, uint32_t counter);

// Call at least once in half a wrap, with counters read in order. Returns now in ticks.
uint64_t board_time_update(board_time* self, uint32_t counter);

// A captured or programmed counter value, at most half a wrap before or after the last update.
uint64_t board_time_of(const board_time* self, uint32_t counter);

// Rounded to the nearest; exact for 584 years.
uint64_t ticks_to_ns(uint64_t ticks, uint32_t tick_hz);
int64_t ns_to_ticks(int64_t ns, uint32_t tick_hz);

#ifdef __cplusplus
}
#endif
