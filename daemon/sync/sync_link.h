// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "lighting/result.h"

namespace lightwell {

// Bytes to the sync board and back. Used by one thread.
class SyncLink {
 public:
  virtual ~SyncLink() = default;
  // Bytes that arrived, up to the buffer's size; 0: none within the timeout. failed: the board is gone.
  virtual Result<std::size_t> read(std::span<std::uint8_t> buffer, std::chrono::milliseconds timeout) = 0;
  // All of them, in order; they may still be on their way when it returns. failed: the board is gone, or has taken nothing
  // for a second.
  virtual Status write(std::span<const std::uint8_t> bytes) = 0;
};

using OpenSyncLink = std::function<Result<std::unique_ptr<SyncLink>>()>;

// Where links come from, while boards come and go. Used by one thread, the one that uses its links.
class SyncPort {
 public:
  virtual ~SyncPort() = default;
  // failed: nothing there, no right to use it, or it is no board; one line that says what to do.
  virtual Result<std::unique_ptr<SyncLink>> open() = 0;
  // Waits, at most so long. True: another open() may end differently.
  virtual bool wait(std::chrono::milliseconds most) = 0;
};

// Where a board is to be found: "usb" (the first), "usb:SERIAL" or "serial:/dev/ttyACM0".
struct SyncAddress {
  enum class Kind { usb, serial } kind = Kind::usb;
  std::string place;  // serial number, or path; may be empty for usb
};
// usage: names what is allowed.
Result<SyncAddress> parse_sync_address(const std::string& text);

std::unique_ptr<SyncPort> make_sync_port(const SyncAddress& address);
// USB says what has been plugged in; where it does not, it is asked. serial: empty for the first board.
std::unique_ptr<SyncPort> make_usb_port(const std::string& serial);
// Looked at again three times a second.
std::unique_ptr<SyncPort> make_polled_port(OpenSyncLink open);

// One try, as SyncPort::open.
Result<std::unique_ptr<SyncLink>> open_sync_link(const SyncAddress& address);
Result<std::unique_ptr<SyncLink>> open_serial_link(const std::string& path);

}  // namespace lightwell
