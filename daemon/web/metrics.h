// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "daemon/pipeline/snapshot.h"
#include "daemon/pipeline/status.h"

namespace lightwell {

// What the web server itself counts.
struct WebCounters {
  std::uint64_t requests = 0;
  std::uint64_t refused = 0;         // 4xx for a foreign Host or Origin
  std::uint64_t stream_clients = 0;  // now
  std::uint64_t stream_dropped = 0;  // events that slow clients did not get
};

// Prometheus text format 0.0.4. snapshot: the newest, or null before the first.
std::string metrics_text(const DaemonStatus& status, const Snapshot* snapshot, const WebCounters& web);

}  // namespace lightwell
