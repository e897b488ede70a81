// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The way from reset to main, for every Cortex-M port. Its linker script names the borders; its vectors name the rest.

#include "firmware/port/startup.h"

#include <stdint.h>

extern uint32_t image_data_start, image_data_end, image_data_load, image_bss_start, image_bss_end;

int main(void);

void hang(void) {
  for (;;) {
  }
}

// Runs before the floating point unit is switched on: nothing here may use it.
void reset_handler(void) {
  const uint32_t* from = &image_data_load;
  uint32_t* to = &image_data_start;
  while (to < &image_data_end) *to++ = *from++;
  to = &image_bss_start;
  while (to < &image_bss_end) *to++ = 0;
  (void)main();
  hang();
}
