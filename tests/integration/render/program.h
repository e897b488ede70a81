// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "interface/atomic_file.h"

namespace lightwell::test {

// lightwell-render as a child, its stderr in a file. Killed with the object.
class Program {
 public:
  // environment: "NAME=value" sets, "NAME" removes.
  Program(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
          const std::vector<std::string>& environment = {})
      : stderr_file_(folder / "stderr.txt") {
    std::vector<std::string> words = {std::string(LIGHTWELL_BIN_DIR) + "/lightwell-render"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ != 0) return;
    for (const std::string& entry : environment) {
      const auto equals = entry.find('=');
      if (equals == std::string::npos)
        ::unsetenv(entry.c_str());
      else
        ::setenv(entry.substr(0, equals).c_str(), entry.substr(equals + 1).c_str(), 1);
    }
    const int file = ::open(stderr_file_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::dup2(file, STDERR_FILENO);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  ~Program() {
    if (exit_code_) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  // Exit code once it has ended; 128 + signal where one ended it.
  std::optional<int> ended() {
    int status = 0;
    if (!exit_code_ && ::waitpid(pid_, &status, WNOHANG) == pid_)
      exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return exit_code_;
  }
  int wait() {
    while (!ended()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return *exit_code_;
  }
  void terminate() { ::kill(pid_, SIGTERM); }
  [[nodiscard]] std::string errors() const {
    const auto text = read_text_file(stderr_file_);
    return text ? *text : "";
  }

 private:
  std::filesystem::path stderr_file_;
  pid_t pid_ = 0;
  std::optional<int> exit_code_;
};

}  // namespace lightwell::test
