// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/child_process.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>

#include "tests/support/eventually.h"

namespace lightwell::test {

ChildProcess::ChildProcess(std::vector<std::string> command, std::filesystem::path stderr_file, Limits limits)
    : stderr_file_(std::move(stderr_file)) {
  std::vector<char*> arguments;
  for (std::string& word : command) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const int log = ::open(stderr_file_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  pid_ = ::fork();
  if (pid_ == 0) {
    ::dup2(log, STDERR_FILENO);
    if (limits.file_bytes) {
      ::signal(SIGXFSZ,
               SIG_IGN);  // stays ignored across exec: writing past the limit fails instead of killing
      const rlimit limit{*limits.file_bytes, *limits.file_bytes};
      ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ::execvp(arguments[0], arguments.data());
    ::_exit(127);
  }
  ::close(log);
}

ChildProcess::~ChildProcess() {
  if (!running()) return;
  send(SIGKILL);
  wait_for_end();
}

void ChildProcess::send(int signal) const {
  ::kill(pid_, signal);
}

std::optional<int> ChildProcess::poll_end() {
  int status = 0;
  if (!end_ && ::waitpid(pid_, &status, WNOHANG) == pid_)
    end_ = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  return end_;
}

bool ChildProcess::running() {
  return !poll_end();
}

std::optional<int> ChildProcess::wait_for_end(int seconds) {
  eventually([&] { return poll_end().has_value(); }, std::chrono::seconds(seconds));
  return end_;
}

std::string ChildProcess::stderr_text() const {
  std::ostringstream text;
  text << std::ifstream(stderr_file_).rdbuf();
  return text.str();
}

std::optional<std::string> ChildProcess::wait_for_line(const std::string& marker) {
  std::optional<std::string> rest;
  eventually([&] {
    const std::string text = stderr_text();
    const auto at = text.find(marker);
    const auto end = at == std::string::npos ? at : text.find('\n', at);
    if (end != std::string::npos) rest = text.substr(at + marker.size(), end - at - marker.size());
    return rest.has_value() || !running();
  });
  return rest;
}

}  // namespace lightwell::test
