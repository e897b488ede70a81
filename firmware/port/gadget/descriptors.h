// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// What the board's USB function tells FunctionFS when it starts (linux/usb/functionfs.h): one interface of the class in
// interface/sync_usb.h with a bulk endpoint a direction, at full and at high speed, its name, and what lets Windows bind
// WinUSB without a driver: Microsoft's extended compatible id, and the GUID by which programs find the interface.

#include <cstddef>
#include <vector>

namespace lightwell::sync_gadget {

// To be written to ep0, in this order. The endpoints' files are ep1 (from the host) and ep2 (to the host).
std::vector<std::byte> descriptors();
std::vector<std::byte> strings();

}  // namespace lightwell::sync_gadget
