// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// What the sync board and the daemon say to each other; C11, shared with the firmware. The same bytes on UART
// and USB.
//
// A frame on the wire: COBS(header, payload, CRC) and a zero byte. All integers little-endian.
//   offset 0  u8   protocol version, SYNC_PROTOCOL_VERSION
//   offset 1  u8   message type, sync_message_type
//   offset 2  u16  sequence, counts the sender's frames and wraps
//   offset 4  …    payload, at most SYNC_MAX_PAYLOAD bytes
//   last two  u16  CRC-16/CCITT-FALSE (polynomial 0x1021, start 0xFFFF) over all before it

#include <stdint.h>

#define SYNC_PROTOCOL_VERSION 1u
#define SYNC_HEADER_SIZE 4u
#define SYNC_CRC_SIZE 2u
#define SYNC_MAX_PAYLOAD 240u
#define SYNC_MAX_FRAME (SYNC_HEADER_SIZE + SYNC_MAX_PAYLOAD + SYNC_CRC_SIZE)
// COBS adds one byte a started block of 254, and the zero that ends the frame.
#define SYNC_MAX_WIRE (SYNC_MAX_FRAME + SYNC_MAX_FRAME / 254u + 2u)

enum sync_message_type {
  SYNC_HELLO_REQUEST = 0x01,  // host, no payload
  SYNC_HELLO = 0x02,          // board: u32 schema hash, u32 capabilities, u8 version[3], u8 reserved (0)
  SYNC_PING = 0x03,           // host: u64 t_host_ns
  SYNC_PONG = 0x04,  // board: u64 t_host_ns as received, u64 t_board_us on receipt, u64 t_board_us on sending
  SYNC_FAULT = 0x7f  // board: u8 sync_fault, u8 offending message type
};

enum sync_fault { SYNC_FAULT_UNKNOWN_TYPE = 1, SYNC_FAULT_PAYLOAD_SIZE = 2, SYNC_FAULT_VERSION = 3 };

// Changes with every change of the messages above; both ends compare it in HELLO.
#define SYNC_SCHEMA_HASH 0x4c570001u

#define SYNC_HELLO_PAYLOAD 12u
#define SYNC_PING_PAYLOAD 8u
#define SYNC_PONG_PAYLOAD 24u
#define SYNC_FAULT_PAYLOAD 2u
