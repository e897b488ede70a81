// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lightwell::test {

// A program that runs beside the test, its stderr in a file; killed with the object.
class ChildProcess {
 public:
  struct Limits {
    std::optional<unsigned long> file_bytes;  // RLIMIT_FSIZE, with SIGXFSZ ignored: a full disk
  };
  ChildProcess(std::vector<std::string> command, std::filesystem::path stderr_file, Limits limits = {});
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  void send(int signal) const;
  [[nodiscard]] bool running();
  // Exit code, −signal where it was killed, nullopt where it did not end in the time a busy machine may take.
  std::optional<int> wait_for_end(int seconds = 30);
  [[nodiscard]] std::string stderr_text() const;
  // The rest of the first line of stderr that contains `marker`, from there on; waits for it.
  std::optional<std::string> wait_for_line(const std::string& marker);
  [[nodiscard]] pid_t pid() const { return pid_; }

 private:
  std::optional<int> poll_end();
  std::filesystem::path stderr_file_;
  pid_t pid_ = -1;
  std::optional<int> end_;
};

}  // namespace lightwell::test
