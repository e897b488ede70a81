// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/same_file.h"

namespace lightwell {

Status check_output_is_no_input(const std::filesystem::path& output,
                                std::initializer_list<std::filesystem::path> inputs) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(output, ignored)) return {};  // a terminal may be read and written
  for (const std::filesystem::path& input : inputs)
    if (std::filesystem::equivalent(output, input, ignored))
      return Error{ErrorKind::usage, "output " + output.string() + " is also the input " + input.string() +
                                         ", which is not overwritten"};
  return {};
}

bool is_one_output(const std::filesystem::path& a, const std::filesystem::path& b) {
  if (a.empty() || b.empty()) return false;
  if (a == b) return true;
  std::error_code ignored;
  if (std::filesystem::is_regular_file(a, ignored)) return std::filesystem::equivalent(a, b, ignored);
  if (std::filesystem::exists(a, ignored)) return false;  // a terminal takes both
  const auto whole_a = std::filesystem::weakly_canonical(std::filesystem::absolute(a, ignored), ignored);
  return whole_a == std::filesystem::weakly_canonical(std::filesystem::absolute(b, ignored), ignored);
}

}  // namespace lightwell
