// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/pulses.h"

#include "firmware/core/board_time.h"

enum {
  kMarginUs = 200,  // between the decision and the edge: a loop of the program, and an interrupt
  kFirstMs = 2      // and before the first one
};

void pulses_init(pulses* self, uint32_t tick_hz, uint64_t now) {
  const pulses nothing = {0};
  *self = nothing;
  self->tick_hz = tick_hz;
  timeline_init(&self->own, now, tick_hz, 1, 1);
}

static const timeline* line(const pulses* self) {
  return servo_holds(&self->reference) ? &self->reference.held.line : &self->own;
}

void pulses_configure(pulses* self, const sync_configuration* settings, uint64_t now) {
  self->rate_numerator = settings->rate_numerator;
  self->rate_denominator = settings->rate_denominator;
  self->reference_numerator = settings->reference_numerator;
  self->reference_denominator = settings->reference_denominator;
  self->length = (uint32_t)ns_to_ticks(settings->pulse_ns, self->tick_hz);
  self->running = settings->trigger_on != 0u;
  self->count = 0;
  if (settings->reference == SYNC_REFERENCE_NONE)
    servo_off(&self->reference);
  else
    servo_follow(&self->reference, self->tick_hz, settings->reference_numerator,
                 settings->reference_denominator);
  self->epoch = self->reference.epoch;
  uint64_t step = 1;
  uint32_t parts = 1;
  (void)trigger_ratio(self->rate_numerator, self->rate_denominator, 1, 1, &step, &parts);
  const uint32_t period = (uint32_t)((uint64_t)self->tick_hz * self->rate_denominator / self->rate_numerator);
  timeline_roll(&self->own, now);
  trigger_start(&self->next, &self->own, step, parts, period, ns_to_ticks(settings->phase_ns, self->tick_hz),
                now + (uint64_t)kFirstMs * self->tick_hz / 1000u);
}

void pulses_advance(pulses* self, uint64_t now) {
  timeline_roll(&self->own, now);
  servo_advance(&self->reference, now);
  if (self->epoch == self->reference.epoch || !servo_holds(&self->reference)) return;
  self->epoch = self->reference.epoch;
  uint64_t step;
  uint32_t parts;
  if (trigger_ratio(self->rate_numerator, self->rate_denominator, self->reference_numerator,
                    self->reference_denominator, &step, &parts))
    trigger_move(&self->next, &self->reference.held.line, step, parts);
}

static uint16_t flags(const pulses* self) {
  uint16_t value = 0;
  if (self->reference.state == SYNC_LOCK_LOCKED) value = SYNC_TRIGGER_LOCKED;
  if (self->reference.state == SYNC_LOCK_HOLDOVER) value = SYNC_TRIGGER_HOLDOVER;
  if (self->next.phase_error != 0) value |= SYNC_TRIGGER_SLEWING;
  if (self->skipped) value |= SYNC_TRIGGER_SKIPPED;
  return value;
}

static int32_t phase_ns(const pulses* self) {
  const int64_t error = self->next.phase_error;  // below a period of 1 s
  return (int32_t)(error * 1000000 / (int64_t)self->tick_hz * 1000);
}

bool pulses_take(pulses* self, uint64_t now, pulse* taken) {
  if (!self->running || self->count == (unsigned)PULSES_AHEAD) return false;
  if (trigger_skip(&self->next, line(self), now + (uint64_t)kMarginUs * self->tick_hz / 1000000u))
    self->skipped = true;
  pulse* slot = &self->ahead[(self->first + self->count) % (unsigned)PULSES_AHEAD];
  slot->n = self->next.n;
  slot->tick = self->next.next;
  slot->phase_ns = phase_ns(self);
  slot->flags = flags(self);
  self->skipped = false;
  ++self->count;
  *taken = *slot;
  trigger_fired(&self->next, line(self));
  return true;
}

bool pulses_done(pulses* self, bool made, pulse* done) {
  if (self->count == 0u) return false;  // of a train that has been configured away
  *done = self->ahead[self->first];
  self->first = (self->first + 1u) % (unsigned)PULSES_AHEAD;
  --self->count;
  if (!made) {
    ++self->missed;
    self->skipped = true;
  } else {
    ++self->sent;
  }
  return true;
}
