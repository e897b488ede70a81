// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/board.h"

static void put_u32(uint8_t* to, uint32_t value) {
  for (unsigned i = 0; i < 4u; ++i) to[i] = (uint8_t)(value >> (8u * i));
}

static void put_u64(uint8_t* to, uint64_t value) {
  for (unsigned i = 0; i < 8u; ++i) to[i] = (uint8_t)(value >> (8u * i));
}

void board_init(board* self, uint32_t counter_us) {
  frame_receiver_init(&self->receiver);
  board_clock_init(&self->clock, counter_us);
  self->sequence = 0;
}

static size_t send(board* self, uint8_t type, const uint8_t* payload, size_t size, uint8_t* wire) {
  return frame_encode(type, self->sequence++, payload, size, wire);
}

static size_t fault(board* self, uint8_t what, uint8_t type, uint8_t* wire) {
  const uint8_t payload[SYNC_FAULT_PAYLOAD] = {what, type};
  return send(self, SYNC_FAULT, payload, sizeof payload, wire);
}

static size_t hello(board* self, uint8_t* wire) {
  uint8_t payload[SYNC_HELLO_PAYLOAD] = {0};
  put_u32(payload, SYNC_SCHEMA_HASH);
  put_u32(payload + 4, 0);  // capabilities: none beside HELLO and PING
  payload[9] = 1;           // version 0.1.0
  return send(self, SYNC_HELLO, payload, sizeof payload, wire);
}

static size_t pong(board* self, const frame_view* ping, uint64_t received_us, uint32_t counter_us,
                   uint8_t* wire) {
  uint8_t payload[SYNC_PONG_PAYLOAD];
  for (size_t i = 0; i < SYNC_PING_PAYLOAD; ++i) payload[i] = ping->payload[i];
  put_u64(payload + 8, received_us);
  put_u64(payload + 16, board_clock_us(&self->clock, counter_us));
  return send(self, SYNC_PONG, payload, sizeof payload, wire);
}

size_t board_receive(board* self, uint8_t byte, uint32_t counter_us, uint8_t* wire) {
  frame_view frame;
  const uint64_t now_us = board_clock_us(&self->clock, counter_us);
  if (!frame_receive(&self->receiver, byte, &frame)) return 0;
  if (frame.version != SYNC_PROTOCOL_VERSION) return fault(self, SYNC_FAULT_VERSION, frame.type, wire);
  switch (frame.type) {
    case SYNC_HELLO_REQUEST:
      return frame.payload_size == 0u ? hello(self, wire)
                                      : fault(self, SYNC_FAULT_PAYLOAD_SIZE, frame.type, wire);
    case SYNC_PING:
      return frame.payload_size == SYNC_PING_PAYLOAD ? pong(self, &frame, now_us, counter_us, wire)
                                                     : fault(self, SYNC_FAULT_PAYLOAD_SIZE, frame.type, wire);
    default:
      return fault(self, SYNC_FAULT_UNKNOWN_TYPE, frame.type, wire);
  }
}
