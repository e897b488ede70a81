// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/port/simulator/stream_link.h"

#include <fcntl.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace lightwell::sync_simulator {

namespace {

void make_nonblocking(int fd) {
  const int flags = fcntl(fd, F_GETFL);
  if (flags < 0 || fcntl(fd, F_SETFL, flags | O_NONBLOCK) < 0)
    throw std::runtime_error(std::string("fcntl: ") + std::strerror(errno));
}

}  // namespace

std::unique_ptr<StreamLink> StreamLink::terminal() {
  int own = -1, other = -1;
  char name[128];
  termios raw{};
  cfmakeraw(&raw);
  if (openpty(&own, &other, name, &raw, nullptr) != 0)
    throw std::runtime_error(std::string("no pseudo-terminal: ") + std::strerror(errno));
  make_nonblocking(own);
  return std::unique_ptr<StreamLink>(new StreamLink(own, own, other, name));
}

std::unique_ptr<StreamLink> StreamLink::standard() {
  make_nonblocking(STDIN_FILENO);
  make_nonblocking(STDOUT_FILENO);
  return std::unique_ptr<StreamLink>(new StreamLink(STDIN_FILENO, STDOUT_FILENO, -1, ""));
}

StreamLink::~StreamLink() {
  if (held_ < 0) return;
  close(held_);
  close(in_);
}

bool StreamLink::move(std::deque<std::uint8_t>& from_host, std::deque<std::uint8_t>& to_host) {
  std::uint8_t bytes[4096];
  const ssize_t got = read(in_, bytes, sizeof bytes);
  if (got == 0 && held_ < 0) return false;
  if (got > 0) from_host.insert(from_host.end(), bytes, bytes + got);
  while (!to_host.empty()) {
    std::size_t count = 0;
    while (count < sizeof bytes && count < to_host.size()) {
      bytes[count] = to_host[count];
      ++count;
    }
    const ssize_t sent = write(out_, bytes, count);
    if (sent < 0) return errno == EAGAIN || errno == EINTR;  // else: nobody reads any more
    to_host.erase(to_host.begin(), to_host.begin() + sent);
  }
  return true;
}

}  // namespace lightwell::sync_simulator
