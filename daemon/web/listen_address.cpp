// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/web/listen_address.h"

#include "interface/host_port.h"

namespace lightwell {

Status check_listen_address(const std::string& listen) {
  const auto address = parse_host_port(listen);
  if (!address) return Error{ErrorKind::usage, "[http] listen: " + address.error().message};
  if (is_loopback(address->host)) return {};
  return Error{ErrorKind::usage, "[http] listen = \"" + listen +
                                     "\" is beyond loopback, which needs TLS and a token; this version has "
                                     "neither: use 127.0.0.1, ::1 or localhost, and a tunnel to reach it"};
}

bool is_loopback_host_header(const std::string& host) {
  if (const auto with_port = parse_host_port(host)) return is_loopback(with_port->host);
  if (host == "[::1]") return true;
  return host.find(':') == std::string::npos && is_loopback(host);
}

bool is_own_origin(const std::string& origin, const std::string& host) {
  return origin == "http://" + host;
}

}  // namespace lightwell
