// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/child_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

#include "tests/support/eventually.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::test {

namespace {

std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> list;
  for (std::string& word : words) list.push_back(word.data());
  list.push_back(nullptr);
  return list;
}

// Ours with the changes, made before the fork: other threads of the test may hold what setenv needs.
std::vector<std::string> changed_environment(const std::vector<std::string>& changes) {
  std::vector<std::string> all;
  for (char** entry = environ; *entry != nullptr; ++entry) all.emplace_back(*entry);
  for (const std::string& change : changes) {
    const std::string name = change.substr(0, change.find('=')) + "=";
    all.erase(std::remove_if(all.begin(), all.end(),
                             [&](const std::string& entry) { return entry.starts_with(name); }),
              all.end());
    if (change.find('=') != std::string::npos) all.push_back(change);
  }
  return all;
}

std::string whole_text(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace

ChildProcess::ChildProcess(std::vector<std::string> command, std::filesystem::path stderr_file,
                           const Options& options)
    : stderr_file_(std::move(stderr_file)) {
  const std::vector<char*> arguments = pointers(command);
  std::vector<std::string> environment = changed_environment(options.environment);
  const std::vector<char*> variables = pointers(environment);
  const auto open_for_writing = [](const std::filesystem::path& file) {
    return ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  };
  const int in = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  const int err = open_for_writing(stderr_file_);
  const int out = options.stdout_file.empty() ? -1 : open_for_writing(options.stdout_file);
  pid_ = ::fork();
  if (pid_ == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // a test that is killed leaves nothing behind
    ::dup2(in, STDIN_FILENO);
    ::dup2(err, STDERR_FILENO);
    if (out >= 0) ::dup2(out, STDOUT_FILENO);
    if (options.file_bytes) {
      // Stays ignored across exec: writing past the limit fails instead of killing.
      ::signal(SIGXFSZ, SIG_IGN);
      const rlimit limit{*options.file_bytes, *options.file_bytes};
      ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ::execvpe(arguments[0], arguments.data(), variables.data());
    ::_exit(127);
  }
  for (const int fd : {in, err, out})
    if (fd >= 0) ::close(fd);
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

int ChildProcess::wait() {
  while (!poll_end()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  return *end_;
}

std::string ChildProcess::stderr_text() const {
  return whole_text(stderr_file_);
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

ProcessResult run_process(const std::string& program, const std::vector<std::string>& arguments) {
  const TemporaryFolder folder;
  std::vector<std::string> command = {program};
  command.insert(command.end(), arguments.begin(), arguments.end());
  ChildProcess::Options options;
  options.stdout_file = folder.path() / "out";
  ChildProcess process(command, folder.path() / "err", options);
  const int exit_code = process.wait();
  return {exit_code, whole_text(options.stdout_file), process.stderr_text()};
}

}  // namespace lightwell::test
