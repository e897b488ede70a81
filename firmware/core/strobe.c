// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/strobe.h"

void strobe_init(strobe* self, uint64_t window, uint64_t period, uint64_t bounce) {
  const strobe nothing = {0};
  const strobe before = *self;
  const uint64_t most = period - period / 8u;
  *self = nothing;
  self->window = window < most ? window : most;
  self->longest = period;
  self->bounce = bounce;
  self->paired = before.paired;
  self->stray = before.stray;
  self->doubled = before.doubled;
  self->unanswered = before.unanswered;
}

void strobe_trigger(strobe* self, uint32_t n, uint64_t tick) {
  self->newest = (self->newest + 1u) % STROBE_TRIGGERS;
  if (self->triggers[self->newest].valid && !self->triggers[self->newest].answered) ++self->unanswered;
  self->triggers[self->newest].n = n;
  self->triggers[self->newest].tick = tick;
  self->triggers[self->newest].valid = true;
  self->triggers[self->newest].answered = false;
}

void strobe_no_trigger(strobe* self, uint32_t n) {
  for (unsigned slot = 0; slot < STROBE_TRIGGERS; ++slot)
    if (self->triggers[slot].n == n) self->triggers[slot].valid = false;
}

// Slot of the last trigger at or before tick; STROBE_TRIGGERS: none is known.
static unsigned trigger_before(const strobe* self, uint64_t tick) {
  for (unsigned age = 0; age < STROBE_TRIGGERS; ++age) {
    const unsigned slot = (self->newest + STROBE_TRIGGERS - age) % STROBE_TRIGGERS;
    if (self->triggers[slot].valid && (int64_t)(tick - self->triggers[slot].tick) >= 0) return slot;
  }
  return STROBE_TRIGGERS;
}

static bool finish(strobe* self, strobe_report* report) {
  if (!self->pending) return false;
  self->report.no_fall = self->open || self->doubtful;
  if (self->report.no_fall) self->report.fall = 0;
  *report = self->report;
  self->pending = false;
  self->open = false;
  self->doubtful = false;
  return true;
}

static bool take_rise(strobe* self, uint64_t tick, strobe_report* report) {
  const unsigned slot = trigger_before(self, tick);
  const bool paired = slot < STROBE_TRIGGERS && tick - self->triggers[slot].tick <= self->window;
  const bool bounced = self->pending && tick - self->last_edge <= self->bounce;
  self->last_edge = tick;
  if (bounced) {
    self->report.bounced = true;
    self->open = true;  // its fall is the one that counts
    ++self->doubled;
    return false;
  }
  if (paired && self->triggers[slot].answered) {  // a second one for the same frame
    self->report.bounced = self->pending;
    ++self->doubled;
    return false;
  }
  if (paired && self->triggers[slot].n == self->doubt_n) self->doubtful = false;
  const bool ended = finish(self, report);
  if (!paired) {
    ++self->stray;
  } else {
    self->triggers[slot].answered = true;
    ++self->paired;
  }
  self->pending = true;
  self->open = true;
  self->report = (strobe_report){.rise = tick, .paired = paired, .n = paired ? self->triggers[slot].n : 0u};
  return ended;
}

static void take_fall(strobe* self, uint64_t tick) {
  const bool bounced = self->pending && !self->open && tick - self->last_edge <= self->bounce;
  const bool ends = self->open && tick - self->report.rise <= self->longest;
  if (!self->open) ++self->doubled;
  if (bounced || ends) {
    const unsigned slot = trigger_before(self, tick);
    self->doubtful =
        self->report.paired && slot < STROBE_TRIGGERS && self->triggers[slot].n != self->report.n;
    if (self->doubtful) {
      self->doubt_n = self->triggers[slot].n;
      self->doubt_end = self->triggers[slot].tick + self->window;
    }
    self->report.fall = tick;
    self->report.bounced = self->report.bounced || bounced;
    self->open = false;
    self->last_edge = tick;
  }
}

bool strobe_edge(strobe* self, uint64_t tick, bool rise, strobe_report* report) {
  if (rise) return take_rise(self, tick, report);
  take_fall(self, tick);
  return false;
}

bool strobe_poll(strobe* self, uint64_t now, strobe_report* report) {
  if (!self->pending || (int64_t)(now - self->last_edge) <= 0) return false;
  const uint64_t quiet = now - self->last_edge;
  if (!self->open && self->doubtful && (int64_t)(now - self->doubt_end) <= 0) return false;
  if (self->open ? now - self->report.rise > self->longest : quiet > self->bounce)
    return finish(self, report);
  return false;
}
