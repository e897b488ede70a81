// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/luminaire_output.h"

#include <filesystem>

#include "cli/command.h"
#include "interface/same_file.h"
#include "interface/writable_output.h"

namespace lightwell::cli {

Status check_luminaire_output(const std::string& out, const std::string& ending,
                              std::span<const std::string> inputs) {
  std::error_code none;
  const std::filesystem::path file = out;
  const bool device = std::filesystem::exists(file, none) && !std::filesystem::is_regular_file(file, none) &&
                      !std::filesystem::is_directory(file, none);
  if (!device && file.extension() != ending)
    return usage("--out is " + out + ", allowed: a name that ends in " + ending);
  for (const std::string& input : inputs)
    if (const Status other = check_output_is_no_input(file, {input}); !other) return other;
  return check_can_write(file);
}

}  // namespace lightwell::cli
