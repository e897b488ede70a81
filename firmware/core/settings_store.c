// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/settings_store.h"

#include "firmware/core/settings.h"

// A copy: u32 magic, u32 schema hash, u32 generation, u32 payload size, payload as on the wire, u32 CRC of all before it.
enum { kMagic = 0x4C575331, kHeader = 16, kMostRecord = kHeader + 80 + 4 };

static uint32_t get(const uint8_t* at) {
  return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static void put(uint8_t* at, uint32_t value) {
  for (unsigned i = 0; i < 4u; ++i) at[i] = (uint8_t)(value >> (8u * i));
}

static uint32_t padded(size_t size) {
  return (uint32_t)((size + 3u) & ~(size_t)3u);
}

static bool load_copy(const flash* memory, uint32_t region, sync_configuration* settings,
                      uint32_t* generation) {
  uint8_t record[kMostRecord];
  const uint32_t size = (uint32_t)sync_payload_size(SYNC_CONFIGURATION);
  const uint32_t whole = (uint32_t)kHeader + padded(size) + 4u;
  memory->read(memory->context, region, 0, record, whole);
  if (get(record) != (uint32_t)kMagic || get(record + 4) != SYNC_SCHEMA_HASH || get(record + 12) != size ||
      get(record + whole - 4u) != flash_crc32(0, record, whole - 4u))
    return false;
  sync_message message;
  settings_refusal refusal;
  if (!sync_unpack(SYNC_CONFIGURATION, record + kHeader, size, &message) ||
      !settings_valid(&message.configuration, &refusal))
    return false;
  *settings = message.configuration;
  *generation = get(record + 8);
  return true;
}

// Region of the newest copy; FLASH_REGIONS: none.
static uint32_t newest(const flash* memory, sync_configuration* settings, uint32_t* generation) {
  sync_configuration other;
  uint32_t other_generation = 0;
  const bool a = load_copy(memory, FLASH_SETTINGS_A, settings, generation);
  if (!load_copy(memory, FLASH_SETTINGS_B, &other, &other_generation))
    return a ? FLASH_SETTINGS_A : FLASH_REGIONS;
  if (a && (int32_t)(*generation - other_generation) > 0) return FLASH_SETTINGS_A;
  *settings = other;
  *generation = other_generation;
  return FLASH_SETTINGS_B;
}

bool settings_load(const flash* memory, sync_configuration* settings) {
  sync_configuration found;
  uint32_t generation = 0;
  if (newest(memory, &found, &generation) == (uint32_t)FLASH_REGIONS) return false;
  *settings = found;
  return true;
}

bool settings_save(const flash* memory, const sync_configuration* settings) {
  sync_configuration before;
  uint32_t generation = 0;
  const uint32_t region = newest(memory, &before, &generation) == (uint32_t)FLASH_SETTINGS_A
                              ? FLASH_SETTINGS_B
                              : FLASH_SETTINGS_A;
  uint8_t record[kMostRecord] = {0};
  sync_message message = {.type = SYNC_CONFIGURATION, .configuration = *settings};
  message.configuration.store = 1;
  const size_t size = sync_pack(&message, record + kHeader);
  const uint32_t whole = (uint32_t)kHeader + padded(size) + 4u;
  put(record, (uint32_t)kMagic);
  put(record + 4, SYNC_SCHEMA_HASH);
  put(record + 8, generation + 1u);
  put(record + 12, (uint32_t)size);
  put(record + whole - 4u, flash_crc32(0, record, whole - 4u));
  if (!memory->erase(memory->context, region) || !memory->write(memory->context, region, 0, record, whole))
    return false;
  sync_configuration again;
  return newest(memory, &again, &generation) == region;  // read back: what is not there was not stored
}
