// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The chip's own flash. An erase stops the core: for 0.3 s of 16 KB, for one to two seconds of 128.
#include "firmware/port/f405/port.h"
#include "firmware/port/f405/registers.h"

typedef struct {
  uint32_t address, size;
  uint32_t sector;
} chip_region;

static const chip_region kRegions[FLASH_REGIONS] = {[FLASH_SETTINGS_A] = {0x08004000u, 16384u, 1u},
                                                    [FLASH_SETTINGS_B] = {0x08008000u, 16384u, 2u},
                                                    [FLASH_IMAGE_A] = {0x08010000u, CHIP_IMAGE_REGION, 4u},
                                                    [FLASH_IMAGE_B] = {0x08020000u, CHIP_IMAGE_REGION, 5u}};

enum { kPatience = 60000000 };
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

static bool lies_within(uint32_t region, uint32_t offset, uint32_t size) {
  return region < (uint32_t)FLASH_REGIONS && offset <= kRegions[region].size &&
         size <= kRegions[region].size - offset;
}

uint32_t chip_flash_address(uint32_t region) {
  return kRegions[region].address;
}

static bool chip_erase(void* context, uint32_t region) {
  (void)context;
  if (!lies_within(region, 0, 0)) return false;
  unlock((uint32_t)kErase | kRegions[region].sector << 3);
  FLASH_CONTROLLER->control |= kGo;
  return finish();
}

static bool chip_write(void* context, uint32_t region, uint32_t offset, const uint8_t* bytes, uint32_t size) {
  (void)context;
  if (!lies_within(region, offset, size)) return false;
  for (uint32_t i = 0; i < size; i += 4u) {
    const uint32_t word = (uint32_t)bytes[i] | (uint32_t)bytes[i + 1u] << 8 | (uint32_t)bytes[i + 2u] << 16 |
                          (uint32_t)bytes[i + 3u] << 24;
    unlock(kProgram);
    *(reg*)(uintptr_t)(kRegions[region].address + offset + i) = word;
    if (!finish()) return false;
  }
  return true;
}

static void chip_read(void* context, uint32_t region, uint32_t offset, uint8_t* bytes, uint32_t size) {
  (void)context;
  const bool within = lies_within(region, offset, size);
  for (uint32_t i = 0; i < size; ++i)
    bytes[i] = within ? *(const volatile uint8_t*)(uintptr_t)(kRegions[region].address + offset + i)
                      : (uint8_t)FLASH_ERASED;
}

const flash chip_flash = {.context = NULL, .erase = chip_erase, .write = chip_write, .read = chip_read};
