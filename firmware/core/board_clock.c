// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/board_clock.h"

void board_clock_init(board_clock* clock, uint32_t counter_us) {
  clock->last = counter_us;
  clock->wraps = 0;
}

uint64_t board_clock_us(board_clock* clock, uint32_t counter_us) {
  if (counter_us < clock->last) ++clock->wraps;
  clock->last = counter_us;
  return ((uint64_t)clock->wraps << 32) | counter_us;
}
