// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/private_network.h"

#include <fcntl.h>
#include <net/if.h>
#include <sched.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <vector>

namespace lightwell::test {
namespace {

bool write_file(const char* path, const std::string& text) {
  const int fd = ::open(path, O_WRONLY | O_CLOEXEC);
  const bool ok = fd >= 0 && ::write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  if (fd >= 0) ::close(fd);
  return ok;
}

constexpr int kRefused = 77;  // the child could not enter; no test program returns it
constexpr const char* kInside = "LIGHTWELL_PRIVATE_NETWORK";

// An ordinary user becomes root of a user namespace first. Only a process with one thread may, and libraries
// start threads before main: a child enters it and runs the test program anew; this process ends with the
// child's result.
void run_again_as_namespace_root() {
  std::string words;
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  std::getline(file, words, {});
  std::vector<char*> arguments;
  for (std::size_t at = 0; at < words.size(); at += std::strlen(&words[at]) + 1)
    arguments.push_back(&words[at]);
  arguments.push_back(nullptr);
  const std::string uid_map = "0 " + std::to_string(::getuid()) + " 1",
                    gid_map = "0 " + std::to_string(::getgid()) + " 1";
  ::setenv(kInside, "1", 1);
  const pid_t child = ::fork();
  if (child == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::unshare(CLONE_NEWUSER | CLONE_NEWNET) == 0 && write_file("/proc/self/uid_map", uid_map) &&
        write_file("/proc/self/setgroups", "deny") && write_file("/proc/self/gid_map", gid_map))
      ::execv("/proc/self/exe", arguments.data());
    ::_exit(kRefused);
  }
  int status = 0;
  ::unsetenv(kInside);
  if (child < 0 || ::waitpid(child, &status, 0) != child) return;
  if (WIFEXITED(status) && WEXITSTATUS(status) == kRefused) return;
  std::fflush(nullptr);
  ::_exit(WIFEXITED(status) ? WEXITSTATUS(status) : 1);
}

}  // namespace

std::string enter_private_network() {
  if (std::getenv(kInside) == nullptr && ::unshare(CLONE_NEWNET) != 0) {
    run_again_as_namespace_root();
    return "the system allows no network namespace";
  }
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  ifreq request{};
  std::strcpy(request.ifr_name, "lo");
  request.ifr_flags = IFF_UP | IFF_RUNNING | IFF_LOOPBACK;
  const bool up = fd >= 0 && ::ioctl(fd, SIOCSIFFLAGS, &request) == 0;
  if (fd >= 0) ::close(fd);
  return up ? std::string() : std::string("loopback interface: ") + std::strerror(errno);
}

}  // namespace lightwell::test
