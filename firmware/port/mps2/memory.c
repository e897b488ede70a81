// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Flash in the board's PSRAM, which keeps its content over a reset: ones by an erase, zeros by a write. It holds the settings;
// what lies outside of it reads as erased.
#include "firmware/port/mps2/memory.h"

enum { kRegion = 4096, kSettings = 2 };

static volatile uint8_t* at(uint32_t region, uint32_t offset) {
  return (volatile uint8_t*)(uintptr_t)(0x21000000u + region * (uint32_t)kRegion + offset);
}

static bool lies_within(uint32_t region, uint32_t offset, uint32_t size) {
  return region < (uint32_t)kSettings && offset <= (uint32_t)kRegion && size <= (uint32_t)kRegion - offset;
}

static bool ram_erase(void* context, uint32_t region) {
  (void)context;
  if (!lies_within(region, 0, kRegion)) return false;
  for (uint32_t i = 0; i < (uint32_t)kRegion; ++i) *at(region, i) = FLASH_ERASED;
  return true;
}

static bool ram_write(void* context, uint32_t region, uint32_t offset, const uint8_t* bytes, uint32_t size) {
  (void)context;
  if (!lies_within(region, offset, size)) return false;
  for (uint32_t i = 0; i < size; ++i) *at(region, offset + i) &= bytes[i];
  return true;
}

static void ram_read(void* context, uint32_t region, uint32_t offset, uint8_t* bytes, uint32_t size) {
  (void)context;
  const bool within = lies_within(region, offset, size);
  for (uint32_t i = 0; i < size; ++i) bytes[i] = within ? *at(region, offset + i) : (uint8_t)FLASH_ERASED;
}

const flash ram_flash = {.context = NULL, .erase = ram_erase, .write = ram_write, .read = ram_read};
