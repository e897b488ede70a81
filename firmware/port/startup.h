// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

typedef void (*vector)(void);

void reset_handler(void);
void hang(void);  // a fault: the watchdog starts the board anew

extern uint32_t image_stack_top;  // of the main stack

// The first 16 vectors, alike in every image: stack, reset, faults, and system calls that nothing makes.
#define SYSTEM_VECTORS                                               \
  (vector) & image_stack_top, reset_handler, hang, hang, hang, hang, \
      hang, [11] = hang, [12] = hang, [14] = hang, [15] = hang

enum { SYSTEM_VECTOR_COUNT = 16 };
