// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/port/f405/registers.h"
#include "firmware/port/startup.h"

void edge_interrupt(void);
void uart_interrupt(void);
void light_interrupt(void);
void usb_interrupt(void);

enum { kInterrupts = 82 };

__attribute__((section(".vectors"), used)) static const vector vectors[SYSTEM_VECTOR_COUNT + kInterrupts] = {
    SYSTEM_VECTORS,
    [SYSTEM_VECTOR_COUNT + EDGE_INTERRUPT] = edge_interrupt,
    [SYSTEM_VECTOR_COUNT + UART_INTERRUPT] = uart_interrupt,
    [SYSTEM_VECTOR_COUNT + LIGHT_INTERRUPT] = light_interrupt,
    [SYSTEM_VECTOR_COUNT + USB_INTERRUPT] = usb_interrupt,
};
