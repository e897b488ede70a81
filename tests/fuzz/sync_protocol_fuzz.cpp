// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Any bytes on the sync board's link: the receiver, every message's reader, and both ways round again. After
// whatever came, two frames are sent and the second must arrive.
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "interface/sync_frame.h"

namespace {

void check(bool holds) {
  if (!holds) std::abort();
}

void again(const frame_view& view, const sync_message& message) {
  std::uint8_t payload[SYNC_MAX_PAYLOAD];
  check(sync_pack(&message, payload) == view.payload_size);
  check(view.payload_size == 0 || std::memcmp(payload, view.payload, view.payload_size) == 0);
}

void round_trip(const std::uint8_t* data, std::size_t size) {
  std::uint8_t wire[SYNC_MAX_WIRE];
  const std::size_t written = frame_encode(data[0], 7, data + 1, size - 1, wire);
  check((written == 0) == (size - 1 > SYNC_MAX_PAYLOAD));
  frame_receiver receiver;
  frame_receiver_init(&receiver);
  frame_view view{};
  for (std::size_t i = 0; i < written; ++i) {
    const bool end = frame_receive(&receiver, wire[i], &view);
    check(end == (i + 1 == written));
  }
  if (written == 0) return;
  check(view.type == data[0] && view.payload_size == size - 1);
  check(size == 1 || std::memcmp(view.payload, data + 1, size - 1) == 0);
  sync_message message;
  if (frame_message(&view, &message)) again(view, message);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  frame_receiver receiver;
  frame_receiver_init(&receiver);
  frame_view view{};
  sync_message message;
  for (std::size_t i = 0; i < size; ++i)
    if (frame_receive(&receiver, data[i], &view)) {
      check(view.payload_size <= SYNC_MAX_PAYLOAD);
      if (frame_message(&view, &message)) again(view, message);
    }
  if (size > 0) round_trip(data, size);

  std::uint8_t wire[SYNC_MAX_WIRE];
  bool arrived = false;
  for (std::uint16_t sequence = 1; sequence <= 2; ++sequence) {
    const std::size_t written = frame_encode(SYNC_HELLO_REQUEST, sequence, nullptr, 0, wire);
    for (std::size_t i = 0; i < written; ++i) arrived = frame_receive(&receiver, wire[i], &view);
  }
  check(arrived && view.sequence == 2);
  return 0;
}
