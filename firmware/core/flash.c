// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/flash.h"

uint32_t flash_crc32(uint32_t crc, const uint8_t* bytes, size_t size) {
  uint32_t rest = ~crc;
  for (size_t i = 0; i < size; ++i) {
    rest ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) rest = (rest >> 1) ^ (0xEDB88320u & (0u - (rest & 1u)));
  }
  return ~rest;
}
