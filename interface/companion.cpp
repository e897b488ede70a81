// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/companion.h"

#include <system_error>

namespace lightwell {

std::filesystem::path companion(std::string_view name) {
  std::error_code error;
  const auto folder = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  const auto beside = folder / name;
  const auto installed = folder.parent_path() / "libexec" / "lightwell" / name;
  return !std::filesystem::exists(beside, error) && std::filesystem::exists(installed, error) ? installed
                                                                                              : beside;
}

}  // namespace lightwell
