// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <stdint.h>

#include "firmware/port/f405/registers.h"
#include "firmware/port/startup.h"

extern uint32_t image_stack_top;

void edge_interrupt(void);
void uart_interrupt(void);
void light_interrupt(void);
void usb_interrupt(void);

enum { kSystem = 16, kInterrupts = 82 };

__attribute__((section(".vectors"), used)) static const vector vectors[kSystem + kInterrupts] = {
    (vector)&image_stack_top,
    reset_handler,
    hang,  // NMI
    hang,  // the faults
    hang,
    hang,
    hang,
    [11] = hang,
    [12] = hang,
    [14] = hang,
    [15] = hang,
    [kSystem + EDGE_INTERRUPT] = edge_interrupt,
    [kSystem + UART_INTERRUPT] = uart_interrupt,
    [kSystem + LIGHT_INTERRUPT] = light_interrupt,
    [kSystem + USB_INTERRUPT] = usb_interrupt,
};
