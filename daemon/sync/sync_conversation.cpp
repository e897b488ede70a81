// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/sync_conversation.h"

#include <fmt/format.h>

#include <array>
#include <span>

#include "daemon/clock.h"
#include "daemon/sync/board_view.h"

namespace lightwell {
namespace {

using namespace std::chrono_literals;

constexpr auto kTurn = 10ms;

}  // namespace

Result<bool> SyncConversation::wait_for(const sync_message& request, sync_type answer,
                                        std::chrono::milliseconds patience, sync_message& received) {
  std::array<std::uint8_t, 1024> bytes{};
  for (const std::int64_t end_ns = mono_now_ns() + std::chrono::nanoseconds(patience).count();
       mono_now_ns() < end_ns;) {
    const auto size = link_.read(bytes, kTurn);
    if (!size) return size.error();
    bool answered = false;
    for (std::size_t i = 0; i < *size; ++i) {  // all of them: the receiver keeps what has begun
      frame_view frame{};
      sync_message message{};
      if (!frame_receive(&receiver_, bytes[i], &frame)) continue;
      if (frame.version != SYNC_PROTOCOL_VERSION)
        return Error{ErrorKind::failed,
                     fmt::format("the board speaks version {} of the protocol, this program {}",
                                 frame.version, SYNC_PROTOCOL_VERSION)};
      if (!frame_message(&frame, &message)) continue;
      if (message.type == SYNC_FAULT && message.fault.type == request.type)
        return Error{ErrorKind::failed, "the board refuses: " + fault_text(message.fault)};
      if (message.type == answer) received = message, answered = true;
    }
    if (answered) return true;
  }
  return false;
}

Result<sync_message> SyncConversation::ask(const sync_message& request, sync_type answer,
                                           std::chrono::milliseconds patience, int tries) {
  for (int i = 0; i < tries; ++i) {
    std::array<std::uint8_t, SYNC_MAX_WIRE> wire{};
    const std::size_t size = frame_encode_message(&request, sequence_++, wire.data());
    if (const Status sent = link_.write(std::span(wire).first(size)); !sent) return sent.error();
    sync_message received{};
    const auto came = wait_for(request, answer, patience, received);
    if (!came) return came.error();
    if (*came) return received;
  }
  return Error{ErrorKind::failed, "the board does not answer; is it powered, is it a Lightwell board?"};
}

Result<sync_hello> SyncConversation::greet() {
  sync_message request{};
  request.type = SYNC_HELLO_REQUEST;
  const auto hello = ask(request, SYNC_HELLO, 500ms, 4);
  if (!hello) return hello.error();
  if (hello->hello.schema_hash != SYNC_SCHEMA_HASH)
    return Error{ErrorKind::failed,
                 fmt::format("the board speaks another protocol ({:08x}, this program {:08x})",
                             hello->hello.schema_hash, SYNC_SCHEMA_HASH)};
  return hello->hello;
}

}  // namespace lightwell
