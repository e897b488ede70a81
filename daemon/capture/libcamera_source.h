// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "daemon/capture/capture_source.h"

namespace lightwell {

// A camera of libcamera by its id, as `lightwell devices` lists it. Options honoured: width, height, pixel_format,
// rate_hz, exposure_us, controls, buffers. Only in builds that found libcamera.
std::unique_ptr<CaptureSource> make_libcamera_source(const std::string& id, const CaptureOptions& options);

}  // namespace lightwell
