// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace lightwell::cli {

// While it lives, a signal that stops the program (Ctrl-C, mpirun ending its other ranks, a batch system's end) first
// says in one line how to go on, then ends it as it would have. Of several processes with one folder the first one
// speaks: it makes the file `stopped` there. Silent where the folder is not there. One at a time.
class StopNotice {
 public:
  explicit StopNotice(const std::filesystem::path& folder);
  ~StopNotice();
  StopNotice(const StopNotice&) = delete;
  StopNotice& operator=(const StopNotice&) = delete;
};

}  // namespace lightwell::cli
