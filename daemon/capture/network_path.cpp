// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/network_path.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstring>

namespace lightwell {
namespace {

std::string text_of(const sockaddr_in& at) {
  std::array<char, INET_ADDRSTRLEN> text{};
  ::inet_ntop(AF_INET, &at.sin_addr, text.data(), text.size());
  return text.data();
}

// The name of the interface that has this address, empty where none has.
std::string interface_of(const std::string& address) {
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return {};
  std::string name;
  for (const ifaddrs* it = list; it != nullptr && name.empty(); it = it->ifa_next) {
    if (it->ifa_addr == nullptr || it->ifa_addr->sa_family != AF_INET) continue;
    sockaddr_in at{};
    std::memcpy(&at, it->ifa_addr, sizeof at);
    if (text_of(at) == address) name = it->ifa_name;
  }
  ::freeifaddrs(list);
  return name;
}

}  // namespace

NetworkPath path_to(const std::string& address) {
  NetworkPath path;
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(9);  // any port: a connected datagram socket only looks up the route
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return path;
  sockaddr_in from{};
  socklen_t size = sizeof from;
  if (::inet_pton(AF_INET, address.c_str(), &to.sin_addr) == 1 &&
      ::connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0 &&
      ::getsockname(fd, reinterpret_cast<sockaddr*>(&from), &size) == 0)
    path.local_address = text_of(from);
  ifreq request{};
  interface_of(path.local_address).copy(request.ifr_name, IFNAMSIZ - 1);
  if (request.ifr_name[0] != '\0' && ::ioctl(fd, SIOCGIFMTU, &request) == 0) path.mtu = request.ifr_mtu;
  ::close(fd);
  return path;
}

}  // namespace lightwell
