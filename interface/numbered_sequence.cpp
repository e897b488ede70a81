// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/numbered_sequence.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>

namespace lightwell {
namespace {

struct Pattern {
  std::string before;
  std::string after;
  std::size_t digits;  // least number of them
};

// The place of a %d or %0Nd at or after `from`, as [begin, end) and N.
struct Placeholder {
  std::size_t begin, end, digits;
};
std::optional<Placeholder> find_placeholder(std::string_view text, std::size_t from = 0) {
  for (std::size_t i = text.find('%', from); i != std::string_view::npos; i = text.find('%', i + 1)) {
    if (text.substr(i).starts_with("%d")) return Placeholder{i, i + 2, 1};
    if (text.size() >= i + 4 && text[i + 1] == '0' && text[i + 2] >= '1' && text[i + 2] <= '9' &&
        text[i + 3] == 'd')
      return Placeholder{i, i + 4, static_cast<std::size_t>(text[i + 2] - '0')};
  }
  return std::nullopt;
}

std::optional<std::uint64_t> number_of(const std::string& name, const Pattern& pattern) {
  if (name.size() < pattern.before.size() + pattern.after.size() + 1) return std::nullopt;
  if (!name.starts_with(pattern.before) || !name.ends_with(pattern.after)) return std::nullopt;
  const std::string digits =
      name.substr(pattern.before.size(), name.size() - pattern.before.size() - pattern.after.size());
  const bool all_digits =
      std::all_of(digits.begin(), digits.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
  const bool padded = digits.size() == pattern.digits || (digits.size() > pattern.digits && digits[0] != '0');
  if (!all_digits || !padded || digits.size() > 18) return std::nullopt;
  return std::stoull(digits);
}

}  // namespace

bool is_numbered_sequence(const std::string& pattern) {
  std::error_code ignored;
  return find_placeholder(pattern).has_value() && !std::filesystem::is_regular_file(pattern, ignored);
}

Result<std::vector<std::filesystem::path>> sequence_files(const std::string& text) {
  const auto bad = [&](const std::string& what) { return Error{ErrorKind::bad_input, text + ": " + what}; };
  const std::filesystem::path path(text);
  const std::string name = path.filename().string();
  const auto place = find_placeholder(name);
  if (!place || find_placeholder(name, place->end) || find_placeholder(path.parent_path().string()))
    return bad("a sequence has one %d or %0Nd, in the file's name");
  const Pattern pattern{name.substr(0, place->begin), name.substr(place->end), place->digits};
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  std::map<std::uint64_t, std::filesystem::path> frames;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (const auto number = number_of(entry->path().filename().string(), pattern))
      frames[*number] = entry->path();
  if (error) return bad("cannot read the folder: " + error.message());
  if (frames.empty()) return bad("no frame of this sequence is there");
  std::vector<std::filesystem::path> files;
  std::uint64_t expected = frames.begin()->first;
  for (const auto& [number, file] : frames) {
    if (number != expected++)
      return bad("frame " + std::to_string(expected - 1) + " is missing before " + file.string());
    files.push_back(file);
  }
  return files;
}

}  // namespace lightwell
