// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/board.h"

void board_init(board* self, uint32_t counter_us) {
  frame_receiver_init(&self->receiver);
  board_time_init(&self->clock, counter_us);
  self->sequence = 0;
}

static size_t send(board* self, const sync_message* message, uint8_t* wire) {
  return frame_encode_message(message, self->sequence++, wire);
}

static size_t fault(board* self, uint8_t code, uint8_t type, uint8_t* wire) {
  const sync_message message = {.type = SYNC_FAULT, .fault = {.code = code, .type = type}};
  return send(self, &message, wire);
}

static size_t hello(board* self, uint8_t* wire) {
  const sync_message message = {
      .type = SYNC_HELLO,
      .hello = {.schema_hash = SYNC_SCHEMA_HASH, .version = {0, 1, 0}, .tick_hz = 1000000u}};
  return send(self, &message, wire);
}

static size_t pong(board* self, const sync_ping* ping, uint64_t received_us, uint32_t counter_us,
                   uint8_t* wire) {
  const sync_message message = {
      .type = SYNC_PONG,
      .pong = {.t_host_ns = ping->t_host_ns,
               .t_received_board_ns = received_us * 1000u,
               .t_sent_board_ns = board_time_update(&self->clock, counter_us) * 1000u}};
  return send(self, &message, wire);
}

size_t board_receive(board* self, uint8_t byte, uint32_t counter_us, uint8_t* wire) {
  frame_view frame;
  sync_message message;
  const uint64_t now_us = board_time_update(&self->clock, counter_us);
  if (!frame_receive(&self->receiver, byte, &frame)) return 0;
  if (frame.version != SYNC_PROTOCOL_VERSION) return fault(self, SYNC_FAULT_VERSION, frame.type, wire);
  if (frame.type != SYNC_HELLO_REQUEST && frame.type != SYNC_PING)
    return fault(self, SYNC_FAULT_UNKNOWN_TYPE, frame.type, wire);
  if (!frame_message(&frame, &message)) return fault(self, SYNC_FAULT_PAYLOAD_SIZE, frame.type, wire);
  return message.type == SYNC_PING ? pong(self, &message.ping, now_us, counter_us, wire) : hello(self, wire);
}
