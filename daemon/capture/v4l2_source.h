// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "daemon/capture/capture_source.h"
#include "daemon/capture/v4l2_calls.h"

namespace lightwell {

// A V4L2 capture device at a path such as /dev/video0, or a link below /dev/v4l/by-id, which follows a camera from
// socket to socket. Options honoured: width, height, pixel_format, rate_hz, exposure_us, controls, buffers.
std::unique_ptr<CaptureSource> make_v4l2_source(const std::string& path, const CaptureOptions& options,
                                                V4l2Calls& calls = system_v4l2_calls());

}  // namespace lightwell
