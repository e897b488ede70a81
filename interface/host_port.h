// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "lighting/result.h"

namespace lightwell {

struct HostPort {
  std::string host;  // IPv4 address, IPv6 address without brackets, or name
  std::uint16_t port = 0;
};

// "ADDRESS:PORT", IPv6 as "[ADDRESS]:PORT"; port 0 to 65535. Fails with usage, naming the text and what is
// allowed.
Result<HostPort> parse_host_port(const std::string& text);

// 127.0.0.0/8, ::1, or "localhost": nothing that another machine can reach or a name server can redirect.
bool is_loopback(const std::string& host);

}  // namespace lightwell
