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

#ifdef __cplusplus
}
#endif
