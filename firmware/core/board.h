// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The board's side of the conversation: bytes in, bytes out, nothing else. One instance a link.

#include <stddef.h>
#include <stdint.h>

#include "firmware/core/board_time.h"
#include "interface/sync_frame.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  frame_receiver receiver;
  board_time clock;
  uint16_t sequence;
} board;

void board_init(board* self, uint32_t counter_us);

// Takes one byte from the host. Where it ends a request, the answer is written to wire (SYNC_MAX_WIRE bytes)
// and its size returned; else 0. counter_us: now.
size_t board_receive(board* self, uint8_t byte, uint32_t counter_us, uint8_t* wire);

#ifdef __cplusplus
}
#endif
