// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/record/take_name.h"

#include <algorithm>
#include <ctime>

namespace lightwell {
namespace {

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' ||
         c == '-' || c == ' ';
}

}  // namespace

std::string take_name_at(std::int64_t utc_ns) {
  const auto seconds = static_cast<std::time_t>(utc_ns / 1'000'000'000);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[64];
  return {text, std::strftime(text, sizeof text, "take %Y-%m-%d %H.%M.%S.mkv", &utc)};
}

Status check_take_name(const std::string& file) {
  constexpr std::size_t kLongest = 128;
  if (std::all_of(file.begin(), file.end(), is_plain) && file.size() > 4 && file.size() <= kLongest &&
      file.find_first_not_of(' ') != file.size() - 4 && file.front() != '.' && file.front() != '-' &&
      file.ends_with(".mkv"))
    return {};
  std::string shown = file.substr(0, kLongest);
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return Error{ErrorKind::usage,
               "recording: file '" + shown + "' is not a plain name such as take.mkv: " + kTakeNameRule};
}

}  // namespace lightwell
