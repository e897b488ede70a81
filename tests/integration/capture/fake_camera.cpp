// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/capture/fake_camera.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>

extern char** environ;

namespace lightwell::test {

FakeCamera::FakeCamera(int width, int height, double rate_hz, const std::string& serial) {
  std::array<int, 2> in{}, out{};
  if (::pipe2(in.data(), O_CLOEXEC) != 0 || ::pipe2(out.data(), O_CLOEXEC) != 0) return;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
  std::array<std::string, 5> words = {LIGHTWELL_BIN_DIR "/test-fake-camera", std::to_string(width),
                                      std::to_string(height), std::to_string(rate_hz), serial};
  std::array<char*, 6> arguments{};
  for (std::size_t i = 0; i < words.size(); ++i) arguments[i] = words[i].data();
  if (::posix_spawn(&pid_, words[0].c_str(), &actions, nullptr, arguments.data(), environ) != 0) pid_ = -1;
  posix_spawn_file_actions_destroy(&actions);
  ::close(in[0]);
  ::close(out[1]);
  to_ = in[1];
  char c = 0;
  while (::read(out[0], &c, 1) == 1 && c != '\n') ready_ = true;
  ::close(out[0]);
}

void FakeCamera::tell(const std::string& command) const {
  const std::string line = command + "\n";
  static_cast<void>(!::write(to_, line.data(), line.size()));
}

void FakeCamera::kill() {
  if (pid_ > 0) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  if (to_ >= 0) ::close(to_);
  pid_ = to_ = -1;
}

}  // namespace lightwell::test
