// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// A button without its bounces: a short press when it is let go, a long one while it is still held.

#include <stdbool.h>
#include <stdint.h>

#include "interface/sync_protocol.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { BUTTON_SETTLE_MS = 20, BUTTON_LONG_MS = 1000 };

typedef struct {
  bool level;           // as last sampled
  bool down;            // settled
  bool reported;        // this press has been told
  uint32_t since_ms;    // level has not changed
  uint32_t pressed_ms;  // when the press began
} button;

void button_init(button* self, uint32_t now_ms);

// Call every few milliseconds; now_ms wraps. True: *press holds what happened; it began at self->pressed_ms.
bool button_sample(button* self, bool level, uint32_t now_ms, sync_press* press);

#ifdef __cplusplus
}
#endif
