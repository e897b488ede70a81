// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Arm MPS2 with the AN386 image (Cortex-M4), as QEMU models it. Addresses: Arm DAI 0386, "Application Note AN386", memory
// map; registers: Arm DDI 0479, "Cortex-M System Design Kit".

#include <stdint.h>

typedef struct {
  volatile uint32_t data;
  volatile uint32_t state;      // bit 0: transmitter full, bit 1: receiver full
  volatile uint32_t control;    // bit 0: transmit, 1: receive, 3: receive interrupt
  volatile uint32_t interrupt;  // write 2: clear receive
  volatile uint32_t divider;
} cmsdk_uart;

typedef struct {
  volatile uint32_t control;    // bit 0: enabled, 3: interrupt
  volatile uint32_t value;      // counts down
  volatile uint32_t reload;     // from here at 0; writing it sets value too
  volatile uint32_t interrupt;  // write 1: clear
} cmsdk_timer;

typedef struct {
  volatile uint32_t load;       // begins anew from here
  volatile uint32_t value;      // counts down
  volatile uint32_t control;    // bit 1: 32 bits, 5: interrupt, 6: periodic, 7: enabled
  volatile uint32_t interrupt;  // write: clear
  volatile uint32_t raw, masked;
  volatile uint32_t next_load;  // from here at 0; what it counts now is left alone
} cmsdk_dual_timer;

#define LINK_UART ((cmsdk_uart*)0x40004000u)  // interrupt 0
#define STIMULUS_UART ((cmsdk_uart*)0x40005000u)
#define RISE_TIMER ((cmsdk_dual_timer*)0x40002020u)  // the second of the pair; interrupt 10
#define FALL_TIMER ((cmsdk_timer*)0x40001000u)       // interrupt 9
#define CLOCK_TIMER ((cmsdk_dual_timer*)0x40002000u)
#define FPGA_LEDS (*(volatile uint32_t*)0x40028000u)
#define NVIC_ENABLE (*(volatile uint32_t*)0xE000E100u)
#define NVIC_PRIORITY_0 (*(volatile uint32_t*)0xE000E400u)  // of interrupts 0 to 3, a byte each
#define COPROCESSOR_ACCESS (*(volatile uint32_t*)0xE000ED88u)

enum { LINK_INTERRUPT = 0, FALL_INTERRUPT = 9, RISE_INTERRUPT = 10 };
