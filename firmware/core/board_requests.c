// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/board_requests.h"

#include "firmware/core/settings.h"
#include "firmware/core/settings_store.h"
#include "firmware/core/version.h"

static void refuse(board* self, uint8_t code, uint8_t type, uint8_t field, int64_t minimum, int64_t maximum) {
  const sync_message message = {
      .type = SYNC_FAULT,
      .fault = {.code = code, .type = type, .field = field, .minimum = minimum, .maximum = maximum}};
  board_send(self, &message);
}

static void say_hello(board* self) {
  const board_facts* facts = self->facts;
  const sync_message message = {.type = SYNC_HELLO,
                                .hello = {.schema_hash = SYNC_SCHEMA_HASH,
                                          .capabilities = facts->capabilities,
                                          .version = {FIRMWARE_MAJOR, FIRMWARE_MINOR, FIRMWARE_PATCH},
                                          .slot = facts->slot,
                                          .tick_hz = facts->tick_hz,
                                          .serial = {facts->serial[0], facts->serial[1], facts->serial[2]}}};
  if (!self->greeted) self->hello_ms = board_ms(self);
  self->greeted = true;
  board_send(self, &message);
}

static void pong(board* self, const sync_ping* ping) {
  const uint64_t now_ns = board_ns(self, self->time.now);
  const sync_message message = {
      .type = SYNC_PONG,
      .pong = {.t_host_ns = ping->t_host_ns, .t_received_board_ns = now_ns, .t_sent_board_ns = now_ns}};
  board_send(self, &message);
}

static void say_configuration(board* self) {
  sync_message message = {.type = SYNC_CONFIGURATION, .configuration = self->settings};
  message.configuration.store = self->stored ? 1u : 0u;
  board_send(self, &message);
}

static void configure(board* self, const sync_configuration* wanted) {
  settings_refusal refusal;
  if (!settings_valid(wanted, &refusal)) {
    refuse(self, SYNC_FAULT_RANGE, SYNC_CONFIGURE, refusal.field, refusal.minimum, refusal.maximum);
    return;
  }
  const bool store = wanted->store != 0u;
  if (store && self->facts->memory == NULL) {
    refuse(self, SYNC_FAULT_UNSUPPORTED, SYNC_CONFIGURE, 0, 0, 0);
    return;
  }
  // An erase holds the core for up to a second.
  if (store && self->host_state == SYNC_HOST_RECORDING) {
    refuse(self, SYNC_FAULT_RECORDING, SYNC_CONFIGURE, 0, 0, 0);
    return;
  }
  if (store && !settings_save(self->facts->memory, wanted)) {
    refuse(self, SYNC_FAULT_FLASH, SYNC_CONFIGURE, 0, 0, 0);
    return;
  }
  self->settings = *wanted;
  self->settings.store = 0;
  self->stored = store;
  self->safe = false;
  board_apply(self);
  say_configuration(self);
}

static void take_host_state(board* self, uint8_t state) {
  if (state > SYNC_HOST_TROUBLE)
    refuse(self, SYNC_FAULT_RANGE, SYNC_HOST_STATE, 0, SYNC_HOST_IDLE, SYNC_HOST_TROUBLE);
  else
    self->host_state = state;
}

// Apart from board_finish_update, whose frame lies under the verifier's.
__attribute__((noinline)) static void answer_update(board* self, uint8_t type, uint8_t code) {
  if (code != 0u) {
    const int64_t awaited = code == SYNC_FAULT_SEQUENCE ? self->images.next : 0;
    const int64_t most =
        code == SYNC_FAULT_RANGE ? (int64_t)self->facts->image_region_size - UPDATE_TRAILER : awaited;
    refuse(self, code, type, 0, code == SYNC_FAULT_RANGE ? 1 : awaited, most);
    return;
  }
  const sync_message message = {
      .type = SYNC_UPDATE_STATE,
      .update_state = {.step = (uint8_t)self->images.step, .next_offset = self->images.next}};
  board_send(self, &message);
}

static void take_update(board* self, const sync_message* request) {
  uint8_t code;
  if ((self->facts->capabilities & SYNC_CAN_UPDATE) == 0u || self->facts->memory == NULL)
    code = SYNC_FAULT_UNSUPPORTED;
  else if (self->host_state == SYNC_HOST_RECORDING)
    code = SYNC_FAULT_RECORDING;
  else if (request->type == SYNC_UPDATE_BEGIN)
    code = update_begin(&self->images, &request->update_begin);
  else if (request->type == SYNC_UPDATE_BLOCK)
    code = update_block(&self->images, &request->update_block);
  else
    code = update_finish(&self->images, &request->update_finish);
  if (code != 0u || request->type != SYNC_UPDATE_FINISH) answer_update(self, request->type, code);
}

void board_finish_update(board* self) {
  if (self->images.unverified) answer_update(self, SYNC_UPDATE_FINISH, update_verify(&self->images));
}

static void answer(board* self, const sync_message* request) {
  switch (request->type) {
    case SYNC_HELLO_REQUEST:
      say_hello(self);
      break;
    case SYNC_PING:
      pong(self, &request->ping);
      break;
    case SYNC_CONFIGURE:
      configure(self, &request->configuration);
      break;
    case SYNC_CONFIGURATION_REQUEST:
      say_configuration(self);
      break;
    case SYNC_STATUS_REQUEST:
      board_send_status(self);
      break;
    case SYNC_HOST_STATE:
      take_host_state(self, request->host_state.state);
      break;
    case SYNC_UPDATE_BEGIN:
    case SYNC_UPDATE_BLOCK:
    case SYNC_UPDATE_FINISH:
      take_update(self, request);
      break;
    default:  // what the board says, not the host
      refuse(self, SYNC_FAULT_UNKNOWN_TYPE, request->type, 0, 0, 0);
      break;
  }
}

void board_answer(board* self, const frame_view* frame) {
  sync_message request;
  if (frame->version != SYNC_PROTOCOL_VERSION)
    refuse(self, SYNC_FAULT_VERSION, frame->type, 0, SYNC_PROTOCOL_VERSION, SYNC_PROTOCOL_VERSION);
  else if (frame_message(frame, &request))
    answer(self, &request);
  else if (sync_payload_size(frame->type) == SIZE_MAX)
    refuse(self, SYNC_FAULT_UNKNOWN_TYPE, frame->type, 0, 0, 0);
  else
    refuse(self, SYNC_FAULT_PAYLOAD_SIZE, frame->type, 0, (int64_t)sync_payload_size(frame->type),
           (int64_t)sync_payload_size(frame->type));
}

bool board_is_hello(const frame_view* frame) {
  sync_message request;
  return frame->version == SYNC_PROTOCOL_VERSION && frame_message(frame, &request) &&
         request.type == SYNC_HELLO_REQUEST;
}
