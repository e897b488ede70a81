// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/frame_name.h"

#include <algorithm>

namespace lightwell {

std::filesystem::path FrameName::file(int frame) const {
  if (!numbered) return before + after;
  std::string number = std::to_string(frame);
  if (static_cast<int>(number.size()) < digits)
    number.insert(0, static_cast<std::size_t>(digits) - number.size(), '0');
  return before + number + after;
}

Result<FrameName> FrameName::parse(const std::string& pattern) {
  const auto wrong = [&](const char* why) {
    return Error{ErrorKind::usage, "--out " + pattern + ": " + why};
  };
  FrameName name;
  const std::string ending = std::filesystem::path(pattern).extension().string();
  if (ending != ".exr" && ending != ".png") return wrong("must end in .exr or .png");
  name.format = ending == ".exr" ? Format::exr : Format::png;
  const std::size_t percent = pattern.find('%');
  if (percent == std::string::npos) {
    name.before = pattern;
    return name;
  }
  const std::size_t letter = pattern.find_first_not_of("0123456789", percent + 1);
  const std::string digits = pattern.substr(percent + 1, letter - percent - 1);
  if (letter == std::string::npos || pattern[letter] != 'd' || digits.size() > 2 ||
      (!digits.empty() && digits[0] != '0'))
    return wrong("the frame number is written %d or %04d");
  if (pattern.find('%', letter) != std::string::npos) return wrong("has more than one frame number");
  name.numbered = true;
  name.digits = digits.empty() ? 0 : std::stoi(digits);
  name.before = pattern.substr(0, percent);
  name.after = pattern.substr(letter + 1);
  return name;
}

}  // namespace lightwell
