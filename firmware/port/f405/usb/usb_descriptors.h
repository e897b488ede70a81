// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// What the board says of itself on USB; interface/sync_usb.h names its class.

#include <stdint.h>

enum {
  USB_FROM_HOST = 0x01,
  USB_TO_HOST = 0x81,
  USB_PACKET = 64
};  // endpoints, and their packets at full speed

// The chip's own number, as HELLO says it: the serial number becomes its 24 hexadecimal digits.
void usb_descriptors_serial(const uint32_t serial[3]);
