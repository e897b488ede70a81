// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>

#include "daemon/sync/sync_link.h"
#include "interface/sync_frame.h"
#include "interface/sync_protocol.h"

namespace lightwell {

// Questions to a sync board and their answers, one at a time, for commands; what the board says by itself is passed by.
class SyncConversation {
 public:
  explicit SyncConversation(SyncLink& link) : link_(link) { frame_receiver_init(&receiver_); }

  // Asks again where no answer comes within the patience, `tries` times in all. failed: the board refuses (its FAULT in
  // words), is silent or gone, or speaks another version of the protocol.
  Result<sync_message> ask(const sync_message& request, sync_type answer, std::chrono::milliseconds patience,
                           int tries);
  // HELLO of a board that speaks our protocol. failed: another schema, as above.
  Result<sync_hello> greet();

 private:
  // Empty: neither came within the patience.
  Result<bool> wait_for(const sync_message& request, sync_type answer, std::chrono::milliseconds patience,
                        sync_message& received);

  SyncLink& link_;
  frame_receiver receiver_{};
  std::uint16_t sequence_ = 0;
};

}  // namespace lightwell
