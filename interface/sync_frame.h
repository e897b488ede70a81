// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Bytes to frames and back: COBS, CRC-16, resynchronisation after garbage; C11, shared with the firmware. No heap,
// no registers. A frame is lost to garbage only where the garbage reaches into it: the next one arrives.

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "interface/sync_protocol.h"

#ifdef __cplusplus
extern "C" {
#endif

// CRC-16/CCITT-FALSE of size bytes.
uint16_t frame_crc16(const uint8_t* bytes, size_t size);

// Whole frame for the wire, the ending zero included; returns its size, 0 if the payload is too large.
// wire: SYNC_MAX_WIRE bytes.
size_t frame_encode(uint8_t type, uint16_t sequence, const uint8_t* payload, size_t payload_size,
                    uint8_t* wire);

// A frame as received; payload points into the receiver and is valid until its next byte.
typedef struct {
  uint8_t version;
  uint8_t type;
  uint16_t sequence;
  const uint8_t* payload;
  size_t payload_size;
} frame_view;

// Whole frame of a message; returns its size, 0 if its type does not exist. wire: SYNC_MAX_WIRE bytes.
size_t frame_encode_message(const sync_message* message, uint16_t sequence, uint8_t* wire);

// The message in a frame. False: another protocol version, an unknown type or a wrong size.
bool frame_message(const frame_view* frame, sync_message* message);

typedef struct {
  uint8_t bytes[SYNC_MAX_WIRE];
  size_t size;
  bool overrun;      // more bytes than a frame can have: skipped up to the next zero
  uint32_t good;     // frames delivered
  uint32_t damaged;  // frames refused: COBS, size or CRC
} frame_receiver;

void frame_receiver_init(frame_receiver* receiver);

// Takes one byte; true when it ended a good frame, which is then in *frame.
bool frame_receive(frame_receiver* receiver, uint8_t byte, frame_view* frame);

#ifdef __cplusplus
}
#endif
