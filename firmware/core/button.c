// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/button.h"

void button_init(button* self, uint32_t now_ms) {
  const button released = {.since_ms = now_ms};
  *self = released;
}

bool button_sample(button* self, bool level, uint32_t now_ms, sync_press* press) {
  if (level != self->level) {
    self->level = level;
    self->since_ms = now_ms;
  }
  const bool settled = now_ms - self->since_ms >= (uint32_t)BUTTON_SETTLE_MS;
  if (settled && self->level != self->down) {
    self->down = self->level;
    if (self->down) {
      self->pressed_ms = self->since_ms;
      self->reported = false;
    } else if (!self->reported) {
      *press = SYNC_BUTTON_SHORT;
      return true;
    }
  }
  if (self->down && !self->reported && now_ms - self->pressed_ms >= (uint32_t)BUTTON_LONG_MS) {
    self->reported = true;
    *press = SYNC_BUTTON_LONG;
    return true;
  }
  return false;
}
