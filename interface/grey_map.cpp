// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/grey_map.h"

#include <array>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

#include "interface/atomic_file.h"

namespace lightwell {
namespace {

constexpr int kMostSide = 16384;

// The next number of the header; comments begin with # and end with the line.
bool take_number(std::string_view& text, int& value) {
  for (;;) {
    while (!text.empty() &&
           (text.front() == ' ' || text.front() == '\t' || text.front() == '\r' || text.front() == '\n'))
      text.remove_prefix(1);
    if (text.empty() || text.front() != '#') break;
    text.remove_prefix(std::min(text.find('\n'), text.size()));
  }
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (read.ec != std::errc()) return false;
  text.remove_prefix(static_cast<std::size_t>(read.ptr - text.data()));
  return true;
}

}  // namespace

bool is_grey_map(const std::filesystem::path& file) {
  std::array<char, 3> head{};
  std::ifstream(file, std::ios::binary).read(head.data(), head.size());
  return head[0] == 'P' && head[1] == '5' &&
         (head[2] == '\n' || head[2] == ' ' || head[2] == '\r' || head[2] == '\t');
}

Result<GreyMap> read_grey_map(const std::filesystem::path& file) {
  const auto content = read_text_file(file, std::size_t{1} << 30);
  if (!content) return content.error();
  const auto bad = [&](const std::string& what) {
    return Error{ErrorKind::bad_input, file.string() + ": " + what};
  };
  std::string_view text = *content;
  if (!text.starts_with("P5")) return bad("does not begin with P5: not a binary grey map");
  text.remove_prefix(2);
  GreyMap map;
  int most = 0;
  if (!take_number(text, map.width) || !take_number(text, map.height) || !take_number(text, most))
    return bad("width, height or greatest value is no number");
  if (map.width < 1 || map.height < 1 || map.width > kMostSide || map.height > kMostSide)
    return bad("is " + std::to_string(map.width) + "x" + std::to_string(map.height) +
               ", allowed: 1x1 to 16384x16384");
  if (most < 1 || most > 65535)
    return bad("greatest value is " + std::to_string(most) + ", allowed: 1 to 65535");
  if (text.empty()) return bad("ends inside the header");
  text.remove_prefix(1);
  map.bytes_a_sample = most > 255 ? 2 : 1;
  const std::size_t bytes = static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height) *
                            static_cast<std::size_t>(map.bytes_a_sample);
  if (text.size() < bytes)
    return bad("has " + std::to_string(text.size()) + " bytes of samples, allowed: " + std::to_string(bytes));
  map.samples.resize(bytes);
  for (std::size_t i = 0; i < bytes; ++i)  // big-endian there
    map.samples[i] = static_cast<std::byte>(text[map.bytes_a_sample == 2 ? i ^ 1 : i]);
  return map;
}

}  // namespace lightwell
