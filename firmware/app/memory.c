// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The functions that a freestanding GCC still calls; the image links no C library.

#include <stddef.h>
#include <stdint.h>

void* memcpy(void* restrict to, const void* restrict from, size_t size);
void* memmove(void* to, const void* from, size_t size);
void* memset(void* to, int value, size_t size);
int memcmp(const void* a, const void* b, size_t size);

void* memcpy(void* restrict to, const void* restrict from, size_t size) {
  uint8_t* out = (uint8_t*)to;
  const uint8_t* in = (const uint8_t*)from;
  while (size-- > 0u) *out++ = *in++;
  return to;
}

void* memmove(void* to, const void* from, size_t size) {
  uint8_t* out = (uint8_t*)to;
  const uint8_t* in = (const uint8_t*)from;
  if (out < in)
    for (size_t i = 0; i < size; ++i) out[i] = in[i];
  else
    while (size-- > 0u) out[size] = in[size];
  return to;
}

void* memset(void* to, int value, size_t size) {
  uint8_t* out = (uint8_t*)to;
  while (size-- > 0u) *out++ = (uint8_t)value;
  return to;
}

int memcmp(const void* a, const void* b, size_t size) {
  const uint8_t* left = (const uint8_t*)a;
  const uint8_t* right = (const uint8_t*)b;
  for (size_t i = 0; i < size; ++i)
    if (left[i] != right[i]) return left[i] < right[i] ? -1 : 1;
  return 0;
}
