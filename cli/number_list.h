// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "interface/option_range.h"

namespace lightwell::cli {

// "1,2.5,-3": exactly `count` finite numbers, or none.
inline std::optional<std::vector<double>> number_list(std::string_view text, std::size_t count) {
  std::vector<double> numbers;
  for (;;) {
    const std::size_t comma = text.find(',');
    const auto value = option_range::parse<double>(text.substr(0, comma));
    if (!value || !std::isfinite(*value)) return std::nullopt;
    numbers.push_back(*value);
    if (comma == std::string_view::npos) break;
    text.remove_prefix(comma + 1);
  }
  if (numbers.size() != count) return std::nullopt;
  return numbers;
}

}  // namespace lightwell::cli
