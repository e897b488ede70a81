// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <libcamera/libcamera.h>

#include <optional>

#include "daemon/capture/capture_session.h"

namespace lightwell {

// The controls that the options ask for: "Name=value, …" first, then rate and exposure, which end automatic exposure.
// fault: one that the camera has not, or out of its range, which is named. Leaves rate, exposure and remarks in settings.
std::optional<CaptureFault> choose_controls(const libcamera::ControlInfoMap& offered,
                                            const CaptureOptions& options, libcamera::ControlList& chosen,
                                            SessionSettings& settings);

}  // namespace lightwell
