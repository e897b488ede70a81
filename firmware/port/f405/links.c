// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Link 0 is the UART, link 1 USB; both are always listened to.
#include "firmware/hal/hal.h"
#include "firmware/port/f405/port.h"

bool hal_link_read(uint8_t link, uint8_t* byte) {
  return link == 0u ? uart_link_read(byte) : usb_link_read(byte);
}

bool hal_link_ready(uint8_t link) {
  return link == 0u ? uart_link_ready() : usb_link_ready();
}

void hal_link_write(uint8_t link, uint8_t byte) {
  if (link == 0u)
    uart_link_write(byte);
  else
    usb_link_write(byte);
}
