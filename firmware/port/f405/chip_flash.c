// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The chip's own flash: sectors 1 and 2, of 16 KB, hold the settings. An erase stops the core for about 0.3 s.
#include "firmware/port/f405/port.h"
#include "firmware/port/f405/registers.h"

enum { kSector = 16384, kFirst = 0x08004000, kPatience = 20000000 };
enum { kErrors = 0xF2, kProgram = 1, kErase = 2, kWords = 2 << 8, kGo = 1 << 16 };
static const uint32_t kBusy = 1u << 16;
static const uint32_t kLock = 1u << 31;

static bool finish(void) {
  for (uint32_t i = 0; i < (uint32_t)kPatience && (FLASH_CONTROLLER->status & kBusy) != 0u; ++i) {
  }
  const bool good = (FLASH_CONTROLLER->status & (kBusy | (uint32_t)kErrors)) == 0u;
  FLASH_CONTROLLER->control = kLock;
  return good;
}

static void unlock(uint32_t mode) {
  if ((FLASH_CONTROLLER->control & kLock) != 0u) {
    FLASH_CONTROLLER->key = 0x45670123u;
    FLASH_CONTROLLER->key = 0xCDEF89ABu;
  }
  FLASH_CONTROLLER->status = kErrors;
  FLASH_CONTROLLER->control = mode | (uint32_t)kWords;
}

static uint32_t start_of(uint32_t region) {
  return (uint32_t)kFirst + region * (uint32_t)kSector;
}

static bool chip_erase(void* context, uint32_t region) {
  (void)context;
  if (region > (uint32_t)FLASH_SETTINGS_B) return false;
  unlock((uint32_t)kErase | (region + 1u) << 3);
  FLASH_CONTROLLER->control |= kGo;
  return finish();
}

static bool chip_write(void* context, uint32_t region, uint32_t offset, const uint8_t* bytes, uint32_t size) {
  (void)context;
  if (region > (uint32_t)FLASH_SETTINGS_B || offset + size > (uint32_t)kSector) return false;
  for (uint32_t i = 0; i < size; i += 4u) {
    const uint32_t word = (uint32_t)bytes[i] | (uint32_t)bytes[i + 1u] << 8 | (uint32_t)bytes[i + 2u] << 16 |
                          (uint32_t)bytes[i + 3u] << 24;
    unlock(kProgram);
    *(reg*)(uintptr_t)(start_of(region) + offset + i) = word;
    if (!finish()) return false;
  }
  return true;
}

static void chip_read(void* context, uint32_t region, uint32_t offset, uint8_t* bytes, uint32_t size) {
  (void)context;
  for (uint32_t i = 0; i < size; ++i)
    bytes[i] = region > (uint32_t)FLASH_SETTINGS_B || offset + i >= (uint32_t)kSector
                   ? (uint8_t)FLASH_ERASED
                   : *(const volatile uint8_t*)(uintptr_t)(start_of(region) + offset + i);
}

const flash chip_flash = {.context = NULL, .erase = chip_erase, .write = chip_write, .read = chip_read};
