// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Frames on their way to the host: whole ones or none. What does not fit is dropped and counted.

#include <stdbool.h>
#include <stdint.h>

#include "interface/sync_frame.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { OUTBOX_BYTES = 1024 };  // a power of two; at 1 Mbit/s 10 ms

typedef struct {
  uint8_t bytes[OUTBOX_BYTES];
  uint32_t head, tail;  // count on and on
  uint16_t sequence;
  uint32_t dropped;
} outbox;

void outbox_init(outbox* self);
void outbox_clear(outbox* self);  // what waits is gone, and not counted as dropped
bool outbox_send(outbox* self, const sync_message* message);

// The next byte for the link; false: none.
bool outbox_take(outbox* self, uint8_t* byte);

#ifdef __cplusplus
}
#endif
