// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/trigger.h"

#include "firmware/core/integer.h"

enum {
  kSlewDivisor = 16
};  // a camera follows a period that is 6 % off; half a period is made up in 8 triggers

bool trigger_ratio(uint32_t rate_numerator, uint32_t rate_denominator, uint32_t reference_numerator,
                   uint32_t reference_denominator, uint64_t* step, uint32_t* parts) {
  const uint64_t up = (uint64_t)reference_numerator * rate_denominator;
  const uint64_t down = (uint64_t)reference_denominator * rate_numerator;
  const uint64_t common = greatest_common_divisor(up, down);
  if (up / common >= (uint64_t)1 << 40 || down / common >= (uint64_t)1 << 30) return false;
  *step = up / common;
  *parts = (uint32_t)(down / common);
  return true;
}

static uint64_t wanted(const trigger* self, const timeline* line) {
  return timeline_tick(line, self->index, self->rest, self->parts) + (uint64_t)self->phase_ticks;
}

static void place(trigger* self, uint64_t k) {
  const uint64_t parts = k * self->step;
  self->index = parts / self->parts;
  self->rest = (uint32_t)(parts % self->parts);
}

// k of the place that is nearest to a tick.
static uint64_t nearest_k(const trigger* self, const timeline* line, uint64_t tick) {
  const int64_t ahead = (int64_t)(tick - (uint64_t)self->phase_ticks - line->base);
  const int64_t period = line->period;
  int64_t edges = ahead / period;
  int64_t rest = ahead % period;
  if (rest < 0) {
    rest += period;
    --edges;
  }
  const int64_t parts = (int64_t)self->parts;
  const int64_t half_parts = ((int64_t)line->index + edges) * parts * 2 + rest * parts * 2 / period;
  const int64_t step = (int64_t)self->step;
  return half_parts <= 0 ? 0u : (uint64_t)((half_parts + step) / (step * 2));
}

static void step_on(trigger* self) {
  const uint64_t parts = self->rest + self->step % self->parts;
  self->index += self->step / self->parts + parts / self->parts;
  self->rest = (uint32_t)(parts % self->parts);
}

// From the trigger before at a tick: as near to where it should be as slewing allows.
static void plan(trigger* self, const timeline* line, uint64_t before) {
  const uint64_t target = wanted(self, line);
  const int64_t slew = self->period / kSlewDivisor;
  const int64_t off = (int64_t)(target - before - self->period);
  self->next = before + self->period + (uint64_t)clamp_i64(off, -slew, slew);
  self->phase_error = (int64_t)(self->next - target);
}

void trigger_start(trigger* self, const timeline* line, uint64_t step, uint32_t parts, uint32_t period,
                   int64_t phase_ticks, uint64_t earliest) {
  self->step = step;
  self->parts = parts;
  self->period = period;
  self->phase_ticks = phase_ticks;
  self->phase_error = 0;
  place(self, nearest_k(self, line, earliest));
  while ((int64_t)(wanted(self, line) - earliest) < 0) step_on(self);
  self->next = wanted(self, line);
}

void trigger_move(trigger* self, const timeline* line, uint64_t step, uint32_t parts) {
  const uint64_t before = self->next - self->period;
  self->step = step;
  self->parts = parts;
  place(self, nearest_k(self, line, self->next));
  plan(self, line, before);
}

void trigger_fired(trigger* self, const timeline* line) {
  const uint64_t before = self->next;
  ++self->n;
  step_on(self);
  plan(self, line, before);
}

bool trigger_skip(trigger* self, const timeline* line, uint64_t earliest) {
  bool skipped = false;
  while ((int64_t)(self->next - earliest) < 0) {
    const uint64_t before = self->next;
    step_on(self);
    plan(self, line, before);
    ++self->late;
    skipped = true;
  }
  return skipped;
}
