// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Vector table and the way from reset to main.

#include <stdint.h>

extern uint32_t image_data_start, image_data_end, image_data_load, image_bss_start, image_bss_end,
    image_stack_top;

int main(void);
void uart0_receive_interrupt(void);
void reset_handler(void);

static void hang(void) {
  for (;;) {
  }
}

void reset_handler(void) {
  const uint32_t* from = &image_data_load;
  for (uint32_t* to = &image_data_start; to < &image_data_end;) *to++ = *from++;
  for (uint32_t* to = &image_bss_start; to < &image_bss_end;) *to++ = 0;
  (void)main();
  hang();
}

typedef void (*vector)(void);

__attribute__((section(".vectors"), used)) static const vector vectors[16 + 1] = {
    (vector)&image_stack_top,
    reset_handler,
    hang,
    hang,
    hang,
    hang,
    hang,
    0,
    0,
    0,
    0,
    hang,
    hang,
    0,
    hang,
    hang,
    uart0_receive_interrupt,
};
