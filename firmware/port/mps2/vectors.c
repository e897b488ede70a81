// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/port/mps2/registers.h"
#include "firmware/port/startup.h"

void uart0_receive_interrupt(void);
void rise_interrupt(void);
void fall_interrupt(void);

__attribute__((section(".vectors"), used)) static const vector vectors[SYSTEM_VECTOR_COUNT + 11] = {
    SYSTEM_VECTORS,
    [SYSTEM_VECTOR_COUNT + LINK_INTERRUPT] = uart0_receive_interrupt,
    [SYSTEM_VECTOR_COUNT + RISE_INTERRUPT] = rise_interrupt,
    [SYSTEM_VECTOR_COUNT + FALL_INTERRUPT] = fall_interrupt,
};
