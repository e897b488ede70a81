// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/outbox.h"

void outbox_init(outbox* self) {
  self->head = 0;
  self->tail = 0;
  self->sequence = 0;
  self->dropped = 0;
}

void outbox_clear(outbox* self) {
  self->tail = self->head;
}

bool outbox_send(outbox* self, const sync_message* message) {
  uint8_t wire[SYNC_MAX_WIRE];
  // A dropped frame uses its number up: the host sees the gap.
  const size_t size = frame_encode_message(message, self->sequence++, wire);
  if (size == 0u || size > (size_t)OUTBOX_BYTES - (self->head - self->tail)) {
    ++self->dropped;
    return false;
  }
  for (size_t i = 0; i < size; ++i) self->bytes[self->head++ % (uint32_t)OUTBOX_BYTES] = wire[i];
  return true;
}

bool outbox_take(outbox* self, uint8_t* byte) {
  if (self->head == self->tail) return false;
  *byte = self->bytes[self->tail++ % (uint32_t)OUTBOX_BYTES];
  return true;
}
