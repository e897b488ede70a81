// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The way from reset to main, for every Cortex-M image. Its linker script names the borders; its vectors name the rest.

#include "firmware/port/startup.h"

#include <stdint.h>

extern uint32_t image_data_start, image_data_end, image_data_load, image_bss_start, image_bss_end;
extern uint32_t image_loop_stack_top;

int main(void);

void hang(void) {
  for (;;) {
  }
}

// Interrupts keep the main stack; the loop goes on with the process stack, so that neither has to have room for the other.
static inline void use_loop_stack(void) {
  __asm volatile(
      "msr psp, %0\n\t"
      "msr control, %1\n\t"
      "isb" ::"r"(&image_loop_stack_top),
      "r"(2)
      : "memory");
}

// Runs before the floating point unit is switched on: nothing here may use it.
void reset_handler(void) {
  const uint32_t* from = &image_data_load;
  uint32_t* to = &image_data_start;
  while (to < &image_data_end) *to++ = *from++;
  to = &image_bss_start;
  while (to < &image_bss_end) *to++ = 0;
  use_loop_stack();
  (void)main();
  hang();
}
