// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Arm MPS2 with the AN386 image (Cortex-M4), as QEMU models it: CMSDK UART 0 is the link, dual timer 1 the
// clock. Addresses: Arm DAI 0386, "Application Note AN386", memory map.

#include "firmware/hal/hal.h"

#define REGISTER(address) (*(volatile uint32_t*)(address))

enum { kClockMhz = 25, kRingSize = 256 };

#define UART_DATA REGISTER(0x40004000u)
#define UART_STATE REGISTER(0x40004004u)      // bit 0: transmit full, bit 1: receive full
#define UART_CONTROL REGISTER(0x40004008u)    // bit 0: transmit, 1: receive, 3: receive interrupt
#define UART_INTERRUPT REGISTER(0x4000400Cu)  // write 2: clear receive
#define UART_DIVIDER REGISTER(0x40004010u)
#define TIMER_LOAD REGISTER(0x40002000u)
#define TIMER_VALUE REGISTER(0x40002004u)  // counts down
#define TIMER_CONTROL REGISTER(0x40002008u)
#define NVIC_ENABLE REGISTER(0xE000E100u)

// One writer (the interrupt), one reader (the loop); indices wrap with their type.
static uint8_t ring[kRingSize];
static volatile uint8_t ring_head;
static volatile uint8_t ring_tail;

// The timer counts cycles and wraps after 171 s; the microseconds are carried on in software.
static uint32_t last_cycles;
static uint32_t whole_us;
static uint32_t rest_cycles;

void uart0_receive_interrupt(void);
void uart0_receive_interrupt(void) {
  UART_INTERRUPT = 2u;
  while ((UART_STATE & 2u) != 0u) ring[ring_head++] = (uint8_t)UART_DATA;
}

void hal_init(void) {
  UART_DIVIDER = 16u;
  UART_CONTROL = (1u << 0) | (1u << 1) | (1u << 3);
  NVIC_ENABLE = 1u << 0;
  TIMER_LOAD = 0xFFFFFFFFu;
  TIMER_CONTROL = 0x80u | 0x02u;  // enabled, 32 bits, free-running
  last_cycles = 0xFFFFFFFFu - TIMER_VALUE;
}

uint32_t hal_counter_us(void) {
  const uint32_t cycles = 0xFFFFFFFFu - TIMER_VALUE;
  rest_cycles += cycles - last_cycles;
  last_cycles = cycles;
  whole_us += rest_cycles / kClockMhz;
  rest_cycles %= kClockMhz;
  return whole_us;
}

bool hal_link_read(uint8_t* byte) {
  if (ring_head == ring_tail) return false;
  *byte = ring[ring_tail++];
  return true;
}

void hal_link_write(uint8_t byte) {
  while ((UART_STATE & 1u) != 0u) {
  }
  UART_DATA = byte;
}
