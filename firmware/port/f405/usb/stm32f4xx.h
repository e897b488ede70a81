// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// What TinyUSB's driver wants of the vendor's device header, by the facts of RM0090 and DS8626.

#include <stdint.h>

#define USB_OTG_FS_PERIPH_BASE 0x50000000u
#define USB_OTG_FS_MAX_IN_ENDPOINTS 4u
#define USB_OTG_FS_TOTAL_FIFO_SIZE 1280u

enum { OTG_FS_IRQn = 67 };

// A barrier: what follows a disabled interrupt must not be done before it.
static inline void NVIC_EnableIRQ(uint32_t number) {
  __asm volatile("" ::: "memory");
  ((volatile uint32_t*)0xE000E100u)[number / 32u] = 1u << (number % 32u);
}

static inline void NVIC_DisableIRQ(uint32_t number) {
  ((volatile uint32_t*)0xE000E180u)[number / 32u] = 1u << (number % 32u);
  __asm volatile("dsb\n\tisb" ::: "memory");
}

static inline void __NOP(void) {
  __asm volatile("nop");
}
