// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/board.h"
#include "firmware/hal/hal.h"

static board self;
static uint8_t wire[SYNC_MAX_WIRE];

int main(void) {
  hal_init();
  board_init(&self, hal_counter_us());
  for (;;) {
    uint8_t byte;
    if (!hal_link_read(&byte)) {
      (void)board_time_update(&self.clock, hal_counter_us());  // an idle link must not miss a wrap
      continue;
    }
    const size_t size = board_receive(&self, byte, hal_counter_us(), wire);
    for (size_t i = 0; i < size; ++i) hal_link_write(wire[i]);
  }
}
