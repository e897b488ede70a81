// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/simulator/loopback_address.h"

#include <arpa/inet.h>
#include <dlfcn.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>

namespace lightwell::simulator {
namespace {

// One list node of our own, for the life of the process. freeifaddrs frees the one block that getifaddrs
// allocated, so a node that is not in it is left alone.
struct Extra {
  bool wanted = false;
  sockaddr_in address{}, mask{};
  char name[3] = {'l', 'o', 0};
  ifaddrs node{};
};
Extra extra;

bool listed(const ifaddrs* list) {
  for (; list != nullptr; list = list->ifa_next) {
    if (list->ifa_addr == nullptr || list->ifa_addr->sa_family != AF_INET) continue;
    const auto* in = reinterpret_cast<const sockaddr_in*>(list->ifa_addr);
    if (in->sin_addr.s_addr == extra.address.sin_addr.s_addr) return true;
  }
  return false;
}

}  // namespace

void list_loopback_address(std::uint32_t ipv4_host_order) {
  if (ipv4_host_order >> 24 != 127) return;
  extra.address.sin_family = extra.mask.sin_family = AF_INET;
  extra.address.sin_addr.s_addr = htonl(ipv4_host_order);
  extra.mask.sin_addr.s_addr = htonl(0xff000000u);
  extra.node.ifa_name = extra.name;
  extra.node.ifa_flags = IFF_UP | IFF_LOOPBACK | IFF_RUNNING;
  extra.node.ifa_addr = reinterpret_cast<sockaddr*>(&extra.address);
  extra.node.ifa_netmask = reinterpret_cast<sockaddr*>(&extra.mask);
  extra.node.ifa_ifu.ifu_broadaddr = extra.node.ifa_addr;  // as Linux gives it for lo
  extra.wanted = true;
}

}  // namespace lightwell::simulator

// Takes the C library's place for every library in this program, and calls it.
extern "C" int getifaddrs(ifaddrs** list) noexcept {
  using Real = int (*)(ifaddrs**);
  static const auto real = reinterpret_cast<Real>(::dlsym(RTLD_NEXT, "getifaddrs"));
  const int result = real != nullptr ? real(list) : -1;
  auto& extra = lightwell::simulator::extra;
  if (result != 0 || *list == nullptr || !extra.wanted || lightwell::simulator::listed(*list)) return result;
  ifaddrs* last = *list;
  while (last->ifa_next != nullptr) last = last->ifa_next;
  last->ifa_next = &extra.node;
  return 0;
}
