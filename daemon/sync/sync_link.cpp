// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/sync_link.h"

#include <algorithm>
#include <thread>
#include <utility>

namespace lightwell {
namespace {

constexpr auto kRetry = std::chrono::milliseconds(300);

class PolledPort final : public SyncPort {
 public:
  explicit PolledPort(OpenSyncLink open) : open_(std::move(open)) {}

  Result<std::unique_ptr<SyncLink>> open() override {
    waited_ = std::chrono::milliseconds(0);
    return open_();
  }
  bool wait(std::chrono::milliseconds most) override {
    std::this_thread::sleep_for(most);
    waited_ += most;
    return waited_ >= kRetry;
  }

 private:
  OpenSyncLink open_;
  std::chrono::milliseconds waited_{0};
};

}  // namespace

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

std::unique_ptr<SyncPort> make_polled_port(OpenSyncLink open) {
  return std::make_unique<PolledPort>(std::move(open));
}

std::unique_ptr<SyncPort> make_sync_port(const SyncAddress& address) {
  if (address.kind == SyncAddress::Kind::usb) return make_usb_port(address.place);
  return make_polled_port([path = address.place] { return open_serial_link(path); });
}

Result<std::unique_ptr<SyncLink>> open_sync_link(const SyncAddress& address) {
  return make_sync_port(address)->open();
}

}  // namespace lightwell
