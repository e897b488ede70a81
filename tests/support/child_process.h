// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lightwell::test {

// A program that runs beside the test, without stdin, its stderr in a file; killed with the object.
class ChildProcess {
 public:
  struct Options {
    std::optional<unsigned long> file_bytes;  // RLIMIT_FSIZE, with SIGXFSZ ignored: a full disk
    std::vector<std::string> environment;     // "NAME=value" sets, "NAME" removes
    std::filesystem::path stdout_file;        // empty: the test's own
  };
  ChildProcess(std::vector<std::string> command, std::filesystem::path stderr_file)
      : ChildProcess(std::move(command), std::move(stderr_file), Options()) {}
  ChildProcess(std::vector<std::string> command, std::filesystem::path stderr_file, const Options& options);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  void send(int signal) const;
  [[nodiscard]] bool running();
  // Exit code, −signal where it was killed, nullopt where it did not end in the time a busy machine may take.
  std::optional<int> wait_for_end(int seconds = 30);
  // The same, however long it takes.
  int wait();
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

struct ProcessResult {
  int exit_code = 0;  // or −signal, 127 where there is no such program
  std::string out;
  std::string err;
};

// Runs a program to its end and keeps what it said.
ProcessResult run_process(const std::string& program, const std::vector<std::string>& arguments);

}  // namespace lightwell::test
