// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// From the internal 16 MHz to 168 MHz, by a crystal of 8 MHz where it starts. No wait is endless: a board without a crystal
// still answers.
#include "firmware/port/f405/port.h"
#include "firmware/port/f405/registers.h"

enum { kPatience = 100000, kHsiHz = 16000000, kTimerHz = 84000000 };
enum { kHseOn = 1 << 16, kHseReady = 1 << 17, kPllOn = 1 << 24, kPllReady = 1 << 25 };
enum { kPllHse = 1 << 22, kUsePll = 2, kWaitStates5 = 5, kCaches = 7 << 8 };

static bool exact;

static bool wait_for(const reg* from, uint32_t bit) {
  for (uint32_t i = 0; i < (uint32_t)kPatience; ++i)
    if ((*from & bit) != 0u) return true;
  return false;
}

uint32_t clocks_start(void) {
  CLOCKS->ahb1 |= 7u | 1u << 22;                       // GPIO A to C, DMA2
  CLOCKS->apb1 |= 1u | 1u << 1 | 1u << 21 | 1u << 28;  // TIM2, TIM3, I2C1, power
  CLOCKS->apb2 |= 1u << 4 | 1u << 8;                   // USART1, ADC1
  CLOCKS->control |= kHseOn;
  const bool crystal = wait_for(&CLOCKS->control, kHseReady);
  // M divides to 1 MHz, N = 336, P = 2: 168 MHz, Q = 7: 48 MHz for USB.
  CLOCKS->pll = (crystal ? 8u | (uint32_t)kPllHse : 16u) | 336u << 6 | 7u << 24;
  CLOCKS->control |= kPllOn;
  if (!wait_for(&CLOCKS->control, kPllReady)) return kHsiHz;
  FLASH_CONTROLLER->access = (uint32_t)kWaitStates5 | (uint32_t)kCaches;
  CLOCKS->configuration = 5u << 10 | 4u << 13;  // APB1 a quarter, APB2 a half
  CLOCKS->configuration |= kUsePll;
  if (!wait_for(&CLOCKS->configuration, (uint32_t)kUsePll << 2)) return kHsiHz;
  exact = crystal;
  return kTimerHz;
}

bool clocks_exact(void) {
  return exact;
}
