// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/guard.h"

void host_guard_init(host_guard* self, uint32_t patience_ms, uint32_t now_ms) {
  self->patience_ms = patience_ms;
  self->heard_ms = now_ms;
  self->silent = false;
}

void host_guard_heard(host_guard* self, uint32_t now_ms) {
  self->heard_ms = now_ms;
  self->silent = false;
}

bool host_guard_silent(host_guard* self, uint32_t now_ms) {
  // Latched: or a silence of 49 days would look like a word.
  if (self->patience_ms != 0u && now_ms - self->heard_ms > self->patience_ms) self->silent = true;
  return self->silent;
}

void camera_guard_init(camera_guard* self, bool on, uint32_t patience_ms, uint32_t off_ms, uint32_t now_ms) {
  const uint32_t cycles = self->cycles;
  const camera_guard fresh = {.patience_ms = patience_ms,
                              .off_ms = off_ms,
                              .wanted = on,
                              .restarted = true,
                              .answered_ms = now_ms,
                              .cycles = cycles};
  *self = fresh;
}

void camera_guard_answered(camera_guard* self, uint32_t now_ms) {
  self->answered_ms = now_ms;
  self->restarted = false;
}

bool camera_guard_power(camera_guard* self, bool triggering, uint32_t now_ms) {
  if (!self->wanted) return false;
  if (self->off) {
    if (now_ms - self->off_since_ms < self->off_ms) return false;
    self->off = false;
    self->restarted = true;
    self->answered_ms = now_ms;
  }
  if (!triggering) self->answered_ms = now_ms;
  const uint32_t patience = self->restarted ? 4u * self->patience_ms : self->patience_ms;
  if (self->patience_ms == 0u || now_ms - self->answered_ms <= patience) return true;
  self->off = true;
  self->off_since_ms = now_ms;
  ++self->cycles;
  return false;
}
