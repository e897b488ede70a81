// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/board_time.h"

enum { kNsPerSecond = 1000000000 };

void board_time_init(board_time* self, uint32_t counter) {
  self->now = counter;
}

uint64_t board_time_update(board_time* self, uint32_t counter) {
  self->now += (uint32_t)(counter - (uint32_t)self->now);
  return self->now;
}

uint64_t board_time_of(const board_time* self, uint32_t counter) {
  const uint32_t ahead = counter - (uint32_t)self->now;
  return ahead < 0x80000000u ? self->now + ahead : self->now - (uint32_t)(0u - ahead);
}

uint64_t ticks_to_ns(uint64_t ticks, uint32_t tick_hz) {
  const uint64_t rest = ticks % tick_hz;
  return ticks / tick_hz * kNsPerSecond + (rest * kNsPerSecond + tick_hz / 2u) / tick_hz;
}

int64_t ns_to_ticks(int64_t ns, uint32_t tick_hz) {
  const uint64_t size = ns < 0 ? 0u - (uint64_t)ns : (uint64_t)ns;
  const uint64_t ticks =
      size / kNsPerSecond * tick_hz + (size % kNsPerSecond * tick_hz + kNsPerSecond / 2) / kNsPerSecond;
  return ns < 0 ? -(int64_t)ticks : (int64_t)ticks;
}
