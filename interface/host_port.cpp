// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/host_port.h"

#include <arpa/inet.h>

#include <charconv>

namespace lightwell {

Result<HostPort> parse_host_port(const std::string& text) {
  const Error wrong{ErrorKind::usage,
                    "'" + text + "' is not ADDRESS:PORT (for example 127.0.0.1:8650 or [::1]:8650)"};
  const auto colon = text.rfind(':');
  if (colon == std::string::npos) return wrong;
  HostPort result;
  result.host = text.substr(0, colon);
  if (result.host.size() > 2 && result.host.front() == '[' && result.host.back() == ']')
    result.host = result.host.substr(1, result.host.size() - 2);
  else if (result.host.find_first_of(":[]") != std::string::npos)
    return wrong;
  if (result.host.empty() || result.host.find_first_of(" \t\r\n/") != std::string::npos) return wrong;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data() + colon + 1, end, result.port);
  if (error != std::errc{} || stop != end)
    return Error{ErrorKind::usage, "'" + text + "': the port must be 0 to 65535"};
  return result;
}

bool is_loopback(const std::string& host) {
  in_addr v4{};
  if (::inet_pton(AF_INET, host.c_str(), &v4) == 1) return (ntohl(v4.s_addr) >> 24) == 127;
  in6_addr v6{};
  if (::inet_pton(AF_INET6, host.c_str(), &v6) == 1) return IN6_IS_ADDR_LOOPBACK(&v6) != 0;
  return host == "localhost";
}

}  // namespace lightwell
