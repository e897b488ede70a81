// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/board_view.h"

#include <fmt/format.h>

namespace lightwell {
namespace {

const char* fault_words(std::uint8_t code) {
  switch (code) {
    case SYNC_FAULT_UNKNOWN_TYPE:
      return "unknown message";
    case SYNC_FAULT_PAYLOAD_SIZE:
      return "wrong size";
    case SYNC_FAULT_VERSION:
      return "another protocol version";
    case SYNC_FAULT_RANGE:
      return "out of range";
    case SYNC_FAULT_RECORDING:
      return "not while recording";
    case SYNC_FAULT_FLASH:
      return "its flash failed";
    case SYNC_FAULT_SEQUENCE:
      return "out of order";
    case SYNC_FAULT_SIGNATURE:
      return "the image is not signed for it";
    case SYNC_FAULT_UNSUPPORTED:
      return "not on this board";
    default:
      return "refused";
  }
}

}  // namespace

const char* name(BoardState state) {
  switch (state) {
    case BoardState::off:
      return "off";
    case BoardState::no_device:
      return "no device";
    case BoardState::wrong_firmware:
      return "wrong firmware";
    case BoardState::connected:
      return "connected";
  }
  return "";
}

Timecode timecode_of(const sync_timecode& t) {
  return {t.hours, t.minutes, t.seconds, t.frames, (t.flags & SYNC_TIMECODE_DROP_FRAME) != 0};
}

std::string fault_text(const sync_fault& fault) {
  std::string text = fault.type == SYNC_CONFIGURE
                         ? fmt::format("the whole configuration, for one value: {}", fault_words(fault.code))
                         : fmt::format("message {:#04x}: {}", fault.type, fault_words(fault.code));
  sync_field_list fields{};
  if (fault.code == SYNC_FAULT_RANGE && sync_fields(fault.type, &fields) && fault.field < fields.count)
    text +=
        fmt::format(", {}: allowed {} to {}", fields.fields[fault.field].name, fault.minimum, fault.maximum);
  return text;
}

}  // namespace lightwell
