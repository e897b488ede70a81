// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/printable.h"

#include <cstdint>

namespace lightwell {
namespace {

void append_escaped(std::string& out, unsigned char code) {
  constexpr std::string_view kHex = "0123456789abcdef";
  switch (code) {
    case '\n':
      out += "\\n";
      return;
    case '\r':
      out += "\\r";
      return;
    case '\t':
      out += "\\t";
      return;
    default:
      out += "\\x";
      out += kHex[code >> 4];
      out += kHex[code & 15];
  }
}

// U+0080 to U+009F, which some terminals take for escape sequences, are 0xC2 0x80 to 0xC2 0x9F in UTF-8.
bool is_c1(unsigned char first, unsigned char second) {
  return first == 0xC2 && second >= 0x80 && second <= 0x9F;
}

}  // namespace

std::string printable(std::string_view message) {
  std::string out;
  out.reserve(message.size());
  for (std::size_t i = 0; i < message.size(); ++i) {
    const auto code = static_cast<unsigned char>(message[i]);
    const auto next = i + 1 < message.size() ? static_cast<unsigned char>(message[i + 1]) : std::uint8_t{0};
    if (code < 0x20 || code == 0x7F)
      append_escaped(out, code);
    else if (is_c1(code, next)) {
      append_escaped(out, next);
      ++i;
    } else
      out += message[i];
  }
  return out;
}

}  // namespace lightwell
