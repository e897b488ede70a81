// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "daemon/pipeline/status.h"

namespace lightwell {

// The worst thing that is wrong, in words a crew can act on; empty when nothing is. Looks at the other fields only.
std::string alarm_for(const DaemonStatus& status);

// The line to log where the calibration's verdict (DaemonStatus::calibration_verdict) went from `before` to `now`; empty:
// nothing to log.
std::string calibration_change(const std::string& before, const std::string& now);

}  // namespace lightwell
