// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The sync board on USB: an interface with one bulk endpoint a direction, found by its class, whatever vendor and product
// the device carries and whatever numbers its endpoints have. The device's serial number is the one in HELLO, 24 hex
// digits. C11, for a firmware that has USB too.

#define SYNC_USB_CLASS 0xffu     // vendor specific
#define SYNC_USB_SUBCLASS 0x4cu  // 'L'
#define SYNC_USB_PROTOCOL 0x57u  // 'W'
