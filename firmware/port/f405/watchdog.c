// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/hal/hal.h"
#include "firmware/port/f405/port.h"
#include "firmware/port/f405/registers.h"

void watchdog_start(void) {
  WATCHDOG->key = 0x5555u;
  WATCHDOG->prescaler = 4;   // 32 kHz / 64
  WATCHDOG->reload = 2000u;  // 4 s: an erase takes two
  WATCHDOG->key = 0xCCCCu;
}

void hal_watchdog(void) {
  WATCHDOG->key = 0xAAAAu;
}
