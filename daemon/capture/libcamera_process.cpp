// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/libcamera_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <utility>

#include "interface/companion.h"

extern char** environ;

namespace lightwell {
namespace {

// False: it still runs after this time.
bool ends_within(pid_t pid, std::chrono::milliseconds time) noexcept {
  const int fd = static_cast<int>(::syscall(SYS_pidfd_open, pid, 0));
  if (fd < 0) return false;
  pollfd ended{fd, POLLIN, 0};
  const bool has = ::poll(&ended, 1, static_cast<int>(time.count())) > 0;
  ::close(fd);
  return has;
}

}  // namespace

std::string libcamera_program() {
  return companion("lightwell-libcamera").string();
}

bool LibcameraProcess::start(const std::string& argument) {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) return false;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
  posix_spawn_file_actions_addclosefrom_np(&actions,
                                           STDERR_FILENO + 1);  // libraries' sockets are not all its to close
  // Signals that end the host end it too, once the host has hung up.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  std::string program = libcamera_program(), words = argument;
  std::array<char*, 3> arguments = {program.data(), words.data(), nullptr};
  const bool started =
      ::posix_spawn(&pid_, program.c_str(), &actions, &attributes, arguments.data(), environ) == 0;
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  if (started) {
    socket_ = ends[0];
    return true;
  }
  ::close(ends[0]);
  pid_ = -1;
  return false;
}

void LibcameraProcess::end(std::chrono::milliseconds patience) noexcept {
  if (socket_ >= 0) ::close(std::exchange(socket_, -1));
  if (pid_ < 0) return;
  if (!ends_within(pid_, patience)) ::kill(pid_, SIGKILL);
  ::waitpid(std::exchange(pid_, -1), nullptr, 0);
}

std::string LibcameraProcess::how_it_ended() noexcept {
  constexpr auto kPatience = std::chrono::milliseconds(200);
  int status = 0;
  if (pid_ < 0 || !ends_within(pid_, kPatience) || ::waitpid(pid_, &status, WNOHANG) != pid_)
    return "hung up";
  pid_ = -1;
  if (WIFSIGNALED(status)) return "ended by signal " + std::to_string(WTERMSIG(status));
  return "ended with status " + std::to_string(WEXITSTATUS(status));
}

}  // namespace lightwell
