// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// What the host asks, and what it is told.

#include "firmware/core/board_state.h"

#ifdef __cplusplus
extern "C" {
#endif

void board_answer(board* self, const frame_view* frame);

// Whether a frame is a good HELLO_REQUEST: with it a host takes the board over.
bool board_is_hello(const frame_view* frame);

// An image that has come is verified (a tenth of a second) and the host answered. Apart from board_answer, and to be called
// from the top of the loop, for a signature needs most of the stack.
void board_finish_update(board* self);

#ifdef __cplusplus
}
#endif
