// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// 64-bit board time out of a 32-bit microsecond counter that wraps every 71.6 minutes.

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  uint32_t last;
  uint32_t wraps;
} board_clock;

void board_clock_init(board_clock* clock, uint32_t counter_us);

// Call at least once a wrap, with counters read in order.
uint64_t board_clock_us(board_clock* clock, uint32_t counter_us);

#ifdef __cplusplus
}
#endif
