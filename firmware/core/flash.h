// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Flash memory as the core sees it: pages that are erased to ones, words that are programmed once. A port drives the
// chip's own; the tests cut its power.

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { FLASH_ERASED = 0xFF };

typedef struct flash {
  void* context;
  // offset and size lie within one region of the port's; of a write they are multiples of 4. False: the chip says it failed.
  bool (*erase)(void* context, uint32_t region);
  bool (*write)(void* context, uint32_t region, uint32_t offset, const uint8_t* bytes, uint32_t size);
  void (*read)(void* context, uint32_t region, uint32_t offset, uint8_t* bytes, uint32_t size);
} flash;

// Regions, each erased as a whole.
enum { FLASH_SETTINGS_A = 0, FLASH_SETTINGS_B = 1, FLASH_IMAGE_A = 2, FLASH_IMAGE_B = 3, FLASH_REGIONS = 4 };

// CRC-32 (IEEE 802.3), to be continued with what it returned; begin with 0.
uint32_t flash_crc32(uint32_t crc, const uint8_t* bytes, size_t size);

#ifdef __cplusplus
}
#endif
