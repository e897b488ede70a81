// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "daemon/pipeline/fit_worker.h"
#include "daemon/pipeline/snapshot.h"
#include "daemon/pipeline/status.h"

namespace lightwell {

// The bodies of the web interface (interface/openapi.yaml). What is not finite is null.
std::string status_json(const DaemonStatus& status);
// lightwell.lights/1 with the frame's number, sequence, times, calibration, delay and spherical harmonics beside it, and
// the newest fit where there is one.
std::string lights_json(const Snapshot& snapshot, const FitSnapshot* fit = nullptr);
// One server-sent event, "id: …\ndata: {…}\n\n"; once a frame, so written by hand into the memory of `event`.
void write_stream_event(const Snapshot& snapshot, std::string& event);
// {"error": message}
std::string error_json(const std::string& message);

}  // namespace lightwell
