// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/libcamera_wire.h"

#include <sys/socket.h>
#include <sys/uio.h>

#include <cerrno>
#include <cstring>
#include <type_traits>

namespace lightwell {
namespace {

static_assert(std::is_trivially_copyable_v<LibcameraMessage>);

constexpr std::size_t kDescriptorBytes = CMSG_SPACE(LibcameraMessage::kMostBuffers * sizeof(int));

// Frames come often and are small: no more is sent than there is.
std::size_t size_of(const LibcameraMessage& message) {
  using Kind = LibcameraMessage::Kind;
  constexpr std::size_t kHead = offsetof(LibcameraMessage, fault);
  switch (message.kind) {
    case Kind::fault:
      return kHead + sizeof message.fault;
    case Kind::ready:
      return kHead + sizeof message.ready;
    case Kind::frame:
      return kHead + sizeof message.frame;
    case Kind::give_back:
      return kHead + sizeof message.buffer;
    case Kind::go:
      break;
  }
  return kHead;
}

}  // namespace

bool send_message(int fd, const LibcameraMessage& message, std::span<const int> descriptors) noexcept {
  iovec body{const_cast<LibcameraMessage*>(&message), size_of(message)};
  alignas(cmsghdr) std::array<char, kDescriptorBytes> room{};
  msghdr header{};
  header.msg_iov = &body;
  header.msg_iovlen = 1;
  if (!descriptors.empty()) {
    header.msg_control = room.data();
    header.msg_controllen = CMSG_SPACE(descriptors.size_bytes());
    cmsghdr* rights = CMSG_FIRSTHDR(&header);
    rights->cmsg_level = SOL_SOCKET;
    rights->cmsg_type = SCM_RIGHTS;
    rights->cmsg_len = CMSG_LEN(descriptors.size_bytes());
    std::memcpy(CMSG_DATA(rights), descriptors.data(), descriptors.size_bytes());
  }
  ssize_t sent = 0;
  do {
    sent = ::sendmsg(fd, &header, MSG_NOSIGNAL | MSG_DONTWAIT);
  } while (sent < 0 && errno == EINTR);
  return sent > 0;
}

bool receive_message(int fd, LibcameraMessage& message, std::vector<int>* descriptors) {
  iovec body{&message, sizeof message};
  alignas(cmsghdr) std::array<char, kDescriptorBytes> room{};
  msghdr header{};
  header.msg_iov = &body;
  header.msg_iovlen = 1;
  header.msg_control = room.data();
  header.msg_controllen = room.size();
  ssize_t size = 0;
  do {
    size = ::recvmsg(fd, &header, MSG_CMSG_CLOEXEC);
  } while (size < 0 && errno == EINTR);
  for (cmsghdr* rights = size > 0 ? CMSG_FIRSTHDR(&header) : nullptr; rights != nullptr;
       rights = CMSG_NXTHDR(&header, rights)) {
    if (descriptors == nullptr || rights->cmsg_type != SCM_RIGHTS) continue;
    descriptors->resize((rights->cmsg_len - CMSG_LEN(0)) / sizeof(int));
    std::memcpy(descriptors->data(), CMSG_DATA(rights), descriptors->size() * sizeof(int));
  }
  return size >= static_cast<ssize_t>(sizeof message.kind) &&
         static_cast<std::size_t>(size) == size_of(message);
}

}  // namespace lightwell
