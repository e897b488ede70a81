// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/child_process.h"

namespace lightwell::test {

// lightwell-render beside the test, its stderr in the folder. environment: as ChildProcess takes it.
inline ChildProcess start_render(const std::filesystem::path& folder,
                                 const std::vector<std::string>& arguments,
                                 const std::vector<std::string>& environment = {}) {
  std::vector<std::string> command = {LIGHTWELL_BIN_DIR "/lightwell-render"};
  command.insert(command.end(), arguments.begin(), arguments.end());
  ChildProcess::Options options;
  options.environment = environment;
  return ChildProcess(command, folder / "stderr.txt", options);
}

}  // namespace lightwell::test
