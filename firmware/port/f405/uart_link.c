// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// USART1 at 1 Mbit/s.
#include "firmware/port/f405/port.h"
#include "firmware/port/f405/registers.h"

enum { kBaud = 1000000, kRing = 256, kReceived = 1 << 5, kOverrun = 1 << 3, kEmpty = 1 << 7 };

// One writer (the interrupt), one reader (the loop); indices wrap with their type.
static uint8_t ring[kRing];
static volatile uint8_t ring_head;
static volatile uint8_t ring_tail;
static volatile uint32_t lost;

void uart_interrupt(void);

void uart_interrupt(void) {
  const uint32_t status = LINK_USART->status;
  if ((status & (uint32_t)kOverrun) != 0u) ++lost;
  if ((status & ((uint32_t)kReceived | (uint32_t)kOverrun)) == 0u) return;
  const uint8_t byte = (uint8_t)LINK_USART->data;  // clears both flags
  if ((uint8_t)(ring_head + 1u) == ring_tail)
    ++lost;
  else
    ring[ring_head++] = byte;
}

void uart_start(uint32_t clock_hz) {
  LINK_USART->baud = clock_hz / (uint32_t)kBaud;
  LINK_USART->control1 = 1u << 13 | 1u << 5 | 1u << 3 | 1u << 2;
}

uint32_t uart_overruns(void) {
  return lost;
}

bool uart_link_read(uint8_t* byte) {
  if (ring_head == ring_tail) return false;
  *byte = ring[ring_tail++];
  return true;
}

bool uart_link_ready(void) {
  return (LINK_USART->status & (uint32_t)kEmpty) != 0u;
}

void uart_link_write(uint8_t byte) {
  LINK_USART->data = byte;
}
