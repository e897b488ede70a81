// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace lightwell {

// How this machine reaches an IPv4 address. Asks the kernel only: nothing is sent.
struct NetworkPath {
  std::string local_address;  // of the interface that leads there; empty where none does
  int mtu = 0;                // largest IP packet of that interface, 0 where it is not known
};

NetworkPath path_to(const std::string& address);

}  // namespace lightwell
