// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "daemon/sync/sync_link.h"

namespace lightwell {
namespace {

Error gone(const std::string& path, const char* what) {
  return {ErrorKind::failed, path + ": " + what};
}

class SerialLink final : public SyncLink {
 public:
  SerialLink(int descriptor, std::string path) : descriptor_(descriptor), path_(std::move(path)) {}
  ~SerialLink() override { close(descriptor_); }

  Result<std::size_t> read(std::span<std::uint8_t> buffer, std::chrono::milliseconds timeout) override {
    if (const Status ready = wait_for(POLLIN, timeout); !ready) return ready.error();
    if (!ready_) return std::size_t{0};
    const ssize_t size = ::read(descriptor_, buffer.data(), buffer.size());
    if (size > 0) return static_cast<std::size_t>(size);
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) return std::size_t{0};
    return gone(path_, size == 0 ? "the board hung up" : std::strerror(errno));
  }

  Status write(std::span<const std::uint8_t> bytes) override {
    while (!bytes.empty()) {
      if (Status ready = wait_for(POLLOUT, std::chrono::seconds(1)); !ready) return ready;
      if (!ready_) return gone(path_, "takes no bytes");
      const ssize_t size = ::write(descriptor_, bytes.data(), bytes.size());
      if (size < 0 && errno != EAGAIN && errno != EINTR) return gone(path_, std::strerror(errno));
      if (size > 0) bytes = bytes.subspan(static_cast<std::size_t>(size));
    }
    return {};
  }

 private:
  Status wait_for(short what, std::chrono::milliseconds timeout) {
    pollfd polled{descriptor_, what, 0};
    const int count = poll(&polled, 1, static_cast<int>(timeout.count()));
    ready_ = count > 0 && (polled.revents & what) != 0;
    if (count < 0 && errno != EINTR) return gone(path_, std::strerror(errno));
    if (count > 0 && !ready_) return gone(path_, "the board hung up");
    return {};
  }

  int descriptor_;
  std::string path_;
  bool ready_ = false;  // what the last wait waited for
};

}  // namespace

Result<std::unique_ptr<SyncLink>> open_serial_link(const std::string& path) {
  const int descriptor = open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0)
    return gone(path, errno == EACCES ? "no right to open it; the user must be in the group dialout"
                                      : std::strerror(errno));
  auto link = std::make_unique<SerialLink>(descriptor, path);
  // Two programs would each take part of what the board says.
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0) return gone(path, "another program has it open");
  termios settings{};
  if (tcgetattr(descriptor, &settings) != 0) return gone(path, "is no serial device");
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB);
  cfsetispeed(&settings, B1000000);  // of a UART; USB serial devices ignore it
  cfsetospeed(&settings, B1000000);
  if (tcsetattr(descriptor, TCSANOW, &settings) != 0) return gone(path, std::strerror(errno));
  tcflush(descriptor, TCIOFLUSH);
  return std::unique_ptr<SyncLink>(std::move(link));
}

}  // namespace lightwell
