// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/pipeline/fit_worker.h"
#include "daemon/pipeline/snapshot.h"
#include "daemon/pipeline/status.h"
#include "interface/probe_messages.h"

namespace lightwell {

// What goes out, from what the frame path and the daemon say. Memory of the messages is reused.
void fill_message(const Snapshot& snapshot, LightFrame& message);
void fill_message(const Snapshot& snapshot, EnvironmentFrame& message);
void fill_message(const FitSnapshot& fit, FitFrame& message);
ProbeStatus status_message(const DaemonStatus& status);

// Every light but the first names an earlier one as its parent.
bool lights_form_a_tree(const std::vector<DirectionalLight>& lights);

// The snapshot's lights as a set.
LightSet light_set(const Snapshot& snapshot);

}  // namespace lightwell
