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

}  // namespace lightwell
