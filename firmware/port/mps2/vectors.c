// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <stdint.h>

#include "firmware/port/mps2/registers.h"
#include "firmware/port/startup.h"

extern uint32_t image_stack_top;

void uart0_receive_interrupt(void);
void rise_interrupt(void);
void fall_interrupt(void);

enum { kSystem = 16 };

__attribute__((section(".vectors"), used)) static const vector vectors[kSystem + 11] = {
    (vector)&image_stack_top,
    reset_handler,
    hang,
    hang,
    hang,
    hang,
    hang,
    [11] = hang,
    [12] = hang,
    [14] = hang,
    [15] = hang,
    [kSystem + LINK_INTERRUPT] = uart0_receive_interrupt,
    [kSystem + RISE_INTERRUPT] = rise_interrupt,
    [kSystem + FALL_INTERRUPT] = fall_interrupt,
};
