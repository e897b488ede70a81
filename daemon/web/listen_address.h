// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lighting/result.h"

namespace lightwell {

// Whether the web server may listen there: "ADDRESS:PORT" on loopback. Beyond it, anybody on the network
// could read and start recordings, so that is refused (usage), naming the TLS and the token that it would
// take.
Status check_listen_address(const std::string& listen);

// Whether an HTTP Host header names this machine's loopback, with any port (a tunnel may have another). A
// page of a foreign site whose name was made to resolve to 127.0.0.1 (DNS rebinding) still sends its own name
// here.
bool is_loopback_host_header(const std::string& host);

// Whether an Origin header is that of the page this server itself serves under the given Host header.
bool is_own_origin(const std::string& origin, const std::string& host);

}  // namespace lightwell
