// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// An image that was built without TinyUSB: the UART is the only link.
#include "firmware/port/f405/port.h"

void usb_interrupt(void);
void usb_interrupt(void) {}

void usb_start(const uint32_t serial[3]) {
  (void)serial;
}
bool usb_link_read(uint8_t* byte) {
  (void)byte;
  return false;
}
bool usb_link_ready(void) {
  return false;
}
void usb_link_write(uint8_t byte) {
  (void)byte;
}
