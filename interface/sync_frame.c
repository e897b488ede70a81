// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/sync_frame.h"

uint16_t frame_crc16(const uint8_t* bytes, size_t size) {
  uint16_t crc = 0xFFFFu;
  for (size_t i = 0; i < size; ++i) {
    crc ^= (uint16_t)((uint16_t)bytes[i] << 8);
    for (int bit = 0; bit < 8; ++bit)
      crc = (uint16_t)((crc & 0x8000u) != 0u ? (uint16_t)(crc << 1) ^ 0x1021u : (uint16_t)(crc << 1));
  }
  return crc;
}

// Consistent Overhead Byte Stuffing (Cheshire and Baker 1999): every zero becomes the distance to the next
// one.
static size_t cobs_encode(const uint8_t* in, size_t size, uint8_t* out) {
  size_t code_at = 0;
  size_t end = 1;
  uint8_t code = 1;
  for (size_t i = 0; i < size; ++i) {
    if (in[i] != 0u) {
      out[end++] = in[i];
      ++code;
    }
    if (in[i] == 0u || code == 0xFFu) {
      out[code_at] = code;
      code_at = end++;
      code = 1;
    }
  }
  out[code_at] = code;
  return end;
}

// In place: the decoded bytes never overtake the encoded ones. 0: malformed.
static size_t cobs_decode(uint8_t* bytes, size_t size) {
  size_t in = 0;
  size_t out = 0;
  while (in < size) {
    const uint8_t code = bytes[in++];
    if ((size_t)code - 1u > size - in) return 0;
    for (uint8_t i = 1; i < code; ++i) bytes[out++] = bytes[in++];
    if (code < 0xFFu && in < size) bytes[out++] = 0;
  }
  return out;
}

size_t frame_encode(uint8_t type, uint16_t sequence, const uint8_t* payload, size_t payload_size,
                    uint8_t* wire) {
  if (payload_size > SYNC_MAX_PAYLOAD) return 0;
  uint8_t frame[SYNC_MAX_FRAME];
  frame[0] = SYNC_PROTOCOL_VERSION;
  frame[1] = type;
  frame[2] = (uint8_t)(sequence & 0xFFu);
  frame[3] = (uint8_t)(sequence >> 8);
  for (size_t i = 0; i < payload_size; ++i) frame[SYNC_HEADER_SIZE + i] = payload[i];
  const size_t body = SYNC_HEADER_SIZE + payload_size;
  const uint16_t crc = frame_crc16(frame, body);
  frame[body] = (uint8_t)(crc & 0xFFu);
  frame[body + 1u] = (uint8_t)(crc >> 8);
  const size_t size = cobs_encode(frame, body + SYNC_CRC_SIZE, wire);
  wire[size] = 0;
  return size + 1u;
}

size_t frame_encode_message(const sync_message* message, uint16_t sequence, uint8_t* wire) {
  uint8_t payload[SYNC_MAX_PAYLOAD];
  const size_t size = sync_pack(message, payload);
  return size == SIZE_MAX ? 0u : frame_encode(message->type, sequence, payload, size, wire);
}

bool frame_message(const frame_view* frame, sync_message* message) {
  return frame->version == SYNC_PROTOCOL_VERSION &&
         sync_unpack(frame->type, frame->payload, frame->payload_size, message);
}

void frame_receiver_init(frame_receiver* receiver) {
  receiver->size = 0;
  receiver->overrun = false;
  receiver->good = 0;
  receiver->damaged = 0;
}

static bool parse(frame_receiver* receiver, frame_view* frame) {
  uint8_t* bytes = receiver->bytes;
  const size_t size = cobs_decode(bytes, receiver->size);
  if (size < SYNC_HEADER_SIZE + SYNC_CRC_SIZE || size > SYNC_MAX_FRAME) return false;
  const size_t body = size - SYNC_CRC_SIZE;
  const uint16_t crc = (uint16_t)(bytes[body] | (uint16_t)((uint16_t)bytes[body + 1u] << 8));
  if (crc != frame_crc16(bytes, body)) return false;
  frame->version = bytes[0];
  frame->type = bytes[1];
  frame->sequence = (uint16_t)(bytes[2] | (uint16_t)((uint16_t)bytes[3] << 8));
  frame->payload = bytes + SYNC_HEADER_SIZE;
  frame->payload_size = body - SYNC_HEADER_SIZE;
  return true;
}

bool frame_receive(frame_receiver* receiver, uint8_t byte, frame_view* frame) {
  if (byte != 0u) {
    if (receiver->size < sizeof receiver->bytes)
      receiver->bytes[receiver->size++] = byte;
    else
      receiver->overrun = true;
    return false;
  }
  const bool anything = receiver->size > 0u;  // zeros between frames are idle line
  const bool good = anything && !receiver->overrun && parse(receiver, frame);
  if (good)
    ++receiver->good;
  else if (anything)
    ++receiver->damaged;
  receiver->size = 0;
  receiver->overrun = false;
  return good;
}
