// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace lightwell {

// Checks of a command line's numbers before they are converted: text that is no number and a number out of range give
// the same line, with the option, the text as typed and what is allowed.
namespace option_range {

template <class T>
std::optional<T> parse(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

inline std::string refusal(const std::string& text, const std::string& allowed) {
  return "value '" + text + "', allowed " + allowed;
}

}  // namespace option_range

inline CLI::Validator whole_numbers(std::int64_t low, std::int64_t high) {
  const std::string allowed = "whole numbers from " + std::to_string(low) + " to " + std::to_string(high);
  return {[=](std::string& text) {
            const auto value = option_range::parse<std::int64_t>(text);
            if (!value || *value < low || *value > high) return option_range::refusal(text, allowed);
            text = std::to_string(*value);  // 010 is ten, not octal
            return std::string();
          },
          ""};
}

// allowed: the range for a person, e.g. "-360 to 360 degrees"
inline CLI::Validator numbers_from(double low, double high, const std::string& allowed) {
  return {[=](std::string& text) {
            const auto value = option_range::parse<double>(text);
            return value && *value >= low && *value <= high ? std::string()
                                                            : option_range::refusal(text, allowed);
          },
          ""};
}

inline CLI::Validator numbers_above_0_to(double high, const std::string& allowed) {
  return {[=](std::string& text) {
            const auto value = option_range::parse<double>(text);
            return value && *value > 0 && *value <= high ? std::string()
                                                         : option_range::refusal(text, allowed);
          },
          ""};
}

// The name of a file to write: '' names none, and - is no name for standard output here.
inline CLI::Validator output_file() {
  return {[](std::string& text) {
            if (text.empty()) return std::string("value '', allowed the name of a file");
            return text == "-"
                       ? std::string("value '-', allowed /dev/stdout for standard output, ./- for a file")
                       : std::string();
          },
          ""};
}

}  // namespace lightwell
