// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The boot program: runs from reset, at the chip's own 16 MHz, without interrupts; chooses the image (core/update.h) and starts
// it under the watchdog. An image that hangs comes back here, and the other one has its turn.
#include "firmware/port/f405/port.h"
#include "firmware/port/f405/registers.h"
#include "firmware/port/startup.h"

enum { kLed = 12, kPortB = 1 << 1 };

// As the core itself starts a program: its stack, its vectors, its entry.
static void start(uint32_t image) {
  const uint32_t* vectors = (const uint32_t*)(uintptr_t)image;
  VECTOR_TABLE = image;
  __asm volatile(
      "msr control, %0\n\t"
      "isb\n\t"
      "msr msp, %1\n\t"
      "bx %2" ::"r"(0),
      "r"(vectors[0]), "r"(vectors[1])
      : "memory");
}

int main(void) {
  COPROCESSOR_ACCESS |= 0xFu << 20;
  watchdog_start();
  // Without a verifier in the build there are no updates: image A is the only one, put there by a programmer.
  const update_verifier* verifier = chip_verifier();
  const uint32_t region =
      verifier == NULL ? (uint32_t)FLASH_IMAGE_A : update_choose(&chip_flash, verifier, CHIP_IMAGE_REGION);
  if (region != (uint32_t)FLASH_REGIONS) start(chip_flash_address(region));
  // Neither may run. The LED stays lit, and the watchdog tries again.
  CLOCKS->ahb1 |= kPortB;
  GPIO_B->mode |= 1u << (2 * kLed);
  GPIO_B->set_reset = 1u << kLed;
  hang();
  return 0;
}
