// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/sync_link.h"

namespace lightwell {

Result<SyncAddress> parse_sync_address(const std::string& text) {
  if (text == "usb") return SyncAddress{SyncAddress::Kind::usb, ""};
  const auto after = [&](const std::string& kind) {
    return text.compare(0, kind.size(), kind) == 0 ? text.substr(kind.size()) : std::string();
  };
  if (const std::string serial = after("usb:"); !serial.empty())
    return SyncAddress{SyncAddress::Kind::usb, serial};
  if (const std::string path = after("serial:"); !path.empty())
    return SyncAddress{SyncAddress::Kind::serial, path};
  return Error{ErrorKind::usage, "board address '" + text + "': allowed usb, usb:SERIAL, serial:/dev/DEVICE"};
}

Result<std::unique_ptr<SyncLink>> open_sync_link(const SyncAddress& address) {
  return address.kind == SyncAddress::Kind::usb ? open_usb_link(address.place)
                                                : open_serial_link(address.place);
}

}  // namespace lightwell
