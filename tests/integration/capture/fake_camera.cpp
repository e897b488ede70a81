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
  start({LIGHTWELL_BIN_DIR "/test-fake-camera", std::to_string(width), std::to_string(height),
         std::to_string(rate_hz), serial});
}

FakeCamera::FakeCamera(std::uint64_t first_id) {
  start({LIGHTWELL_BIN_DIR "/test-feature-camera", FEATURE_CAMERA_XML, std::to_string(first_id)});
}

void FakeCamera::start(std::vector<std::string> words) {
  std::array<int, 2> in{}, out{};
  if (::pipe2(in.data(), O_CLOEXEC) != 0 || ::pipe2(out.data(), O_CLOEXEC) != 0) return;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
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
