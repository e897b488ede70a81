// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/timeline.h"

void timeline_init(timeline* self, uint64_t base, uint32_t tick_hz, uint32_t numerator,
                   uint32_t denominator) {
  const uint64_t ticks = (uint64_t)tick_hz * denominator;
  self->index = 0;
  self->base = base;
  self->base_part = 0;
  self->period = (uint32_t)(ticks / numerator);
  self->period_part = (uint32_t)(((ticks % numerator) << 32) / numerator);
}

uint64_t timeline_tick(const timeline* self, uint64_t index, uint32_t rest, uint32_t parts) {
  const int64_t edges = (int64_t)(index - self->index);
  // Within one period: the whole ticks and what is left of them are divided apart, so that neither overflows.
  const uint64_t share = (uint64_t)rest * self->period;
  const uint64_t share_part = (((share % parts) << 32) + (uint64_t)rest * self->period_part) / parts;
  // edges · period_part fits: edges between a trigger and the base are a few hundred at most.
  const int64_t part = (int64_t)self->base_part + edges * (int64_t)self->period_part + (int64_t)share_part;
  const int64_t half = (int64_t)1 << 31;
  // A right shift of what may be negative rounds down on every compiler of this project (GCC and Clang say so).
  const int64_t whole = edges * (int64_t)self->period + (int64_t)(share / parts) + ((part + half) >> 32);
  return self->base + (uint64_t)whole;
}

void timeline_roll(timeline* self, uint64_t now) {
  while ((int64_t)(now - self->base) >= (int64_t)self->period) {
    timeline_shift_q32(self, (int64_t)timeline_period_q32(self));
    ++self->index;
  }
}

uint64_t timeline_period_q32(const timeline* self) {
  return ((uint64_t)self->period << 32) | self->period_part;
}

void timeline_set_period_q32(timeline* self, uint64_t period_q32) {
  self->period = (uint32_t)(period_q32 >> 32);
  self->period_part = (uint32_t)period_q32;
}

void timeline_shift_q32(timeline* self, int64_t change_q32) {
  const uint64_t part = (uint64_t)self->base_part + ((uint64_t)change_q32 & 0xFFFFFFFFu);
  self->base += (uint64_t)(change_q32 >> 32) + (part >> 32);
  self->base_part = (uint32_t)part;
}
