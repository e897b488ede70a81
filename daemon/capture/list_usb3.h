// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace lightwell {

// A USB3 Vision camera, as its descriptors have it.
struct Usb3Description {
  std::string name;  // what stands behind "aravis:": "VENDOR-SERIAL"
  std::string vendor, model, serial;
};

// On every bus of this machine; opens none.
std::vector<Usb3Description> list_usb3();

}  // namespace lightwell
