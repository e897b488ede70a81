// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/v4l2_calls.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cerrno>

namespace lightwell {
namespace {

class SystemCalls final : public V4l2Calls {
 public:
  int open(const char* path) noexcept override {
    const int fd = ::open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC);
    return fd >= 0 ? fd : -errno;
  }
  void close(int fd) noexcept override { ::close(fd); }
  int ioctl(int fd, unsigned long request, void* argument) noexcept override {
    int result = 0;
    do result = ::ioctl(fd, request, argument);
    while (result < 0 && errno == EINTR);
    return result < 0 ? -errno : 0;
  }
  void* map(int fd, std::size_t bytes, std::int64_t offset) noexcept override {
    void* at = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, offset);
    return at != MAP_FAILED ? at : nullptr;
  }
  void unmap(void* at, std::size_t bytes) noexcept override { ::munmap(at, bytes); }
  Ready wait(int fd, int wake_fd, int timeout_ms) noexcept override {
    std::array<pollfd, 2> fds = {{{fd, POLLIN | POLLPRI, 0}, {wake_fd, POLLIN, 0}}};
    if (::poll(fds.data(), fds.size(), timeout_ms) <= 0) return {};
    const auto is = [&](std::size_t i, int bits) { return (fds[i].revents & bits) != 0; };
    return {is(0, POLLIN), is(0, POLLPRI), is(0, POLLERR | POLLHUP | POLLNVAL), is(1, POLLIN)};
  }
};

}  // namespace

V4l2Calls& system_v4l2_calls() {
  static SystemCalls calls;
  return calls;
}

}  // namespace lightwell
