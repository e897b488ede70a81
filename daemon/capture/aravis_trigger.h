// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arv.h>

#include <optional>

#include "daemon/capture/capture_session.h"

namespace lightwell {

// Has each rising edge at the input options.trigger start an exposure of the time that was set (SFNC: TriggerSelector
// FrameStart, ExposureMode Timed), or ends triggering, or leaves both as they are, as the options say; leaves in settings
// what is in force. Comes after the frame rate, whose setting ends triggering.
std::optional<CaptureFault> set_trigger(ArvCamera* camera, const CaptureOptions& options,
                                        SessionSettings& settings);

}  // namespace lightwell
