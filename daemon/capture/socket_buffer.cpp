// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/socket_buffer.h"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>

namespace lightwell {

std::size_t granted_socket_buffer(int wish_bytes) {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return 0;
  int granted = 0;
  socklen_t size = sizeof granted;
  static_cast<void>(::setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &wish_bytes, sizeof wish_bytes));
  static_cast<void>(::getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &granted, &size));
  ::close(fd);
  return static_cast<std::size_t>(granted) / 2;  // the kernel doubles what it is asked for, socket(7)
}

bool has_packet_socket() {
  const int fd = ::socket(AF_PACKET, SOCK_RAW | SOCK_CLOEXEC, 0);
  if (fd >= 0) ::close(fd);
  return fd >= 0;
}

std::string socket_buffer_remark(std::size_t frame_bytes, std::size_t granted_bytes) {
  if (granted_bytes >= frame_bytes) return {};
  return "receive buffer of " + std::to_string(granted_bytes) + " bytes is smaller than a frame of " +
         std::to_string(frame_bytes) + ", frames will be incomplete: sysctl -w net.core.rmem_max=" +
         std::to_string(std::max<std::size_t>(2 * frame_bytes, 16U << 20));
}

}  // namespace lightwell
