// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/list_usb3.h"

#include <arv.h>

namespace lightwell {

std::vector<Usb3Description> list_usb3() {
  std::vector<Usb3Description> list;
  // This interface alone: a scan of all of them would wait for networks.
  ArvInterface* usb = arv_uv_interface_get_instance();
  arv_interface_update_device_list(usb);
  const auto text = [](const char* words) { return std::string(words != nullptr ? words : ""); };
  for (unsigned i = 0; i < arv_interface_get_n_devices(usb); ++i) {
    Usb3Description d;
    d.vendor = text(arv_interface_get_device_vendor(usb, i));
    d.model = text(arv_interface_get_device_model(usb, i));
    d.serial = text(arv_interface_get_device_serial_nbr(usb, i));
    d.name = d.vendor + "-" + d.serial;
    list.push_back(std::move(d));
  }
  return list;
}

}  // namespace lightwell
