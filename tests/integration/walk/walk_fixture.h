// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/integration/chain/chain.h"

namespace lightwell::test {

// A walk that is recorded into a folder of its own.
class Walk : public Chain {
 protected:
  // A UDP port by process: FreeD and OpenTrackIO have none of their own. Below those that the system hands out.
  static std::string own_port() {
    static int count = 0;
    return std::to_string(20000 + (static_cast<int>(::getpid()) * 4 + count++) % 10000);
  }
  [[nodiscard]] ProcessResult record(const Words& more) const {
    Words arguments = {"record", "--out", take().string(), "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_process(program("lightwell"), arguments);
  }
  [[nodiscard]] std::filesystem::path take() const { return folder_.path() / "take.mkv"; }
  [[nodiscard]] std::filesystem::path poses() const { return folder_.path() / "take.poses.csv"; }
};

}  // namespace lightwell::test
