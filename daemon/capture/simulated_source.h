// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "daemon/capture/capture_source.h"
#include "lighting/calibration.h"
#include "lighting/result.h"

namespace lightwell {

// The simulated probe camera inside this process: same scenes, lens and sensor as lightwell-camera, no network.
// name: a scenario (day, studio, flicker, walk, static, stage, stage@X,Y,Z) or the path of an environment image.
// Options honoured: width, height (640×480 where 0), pixel_format (Mono12), rate_hz (30), exposure_us (the scene's own),
// buffers. Scene time starts with start(); frames leave at the end of their exposure, at multiples of the period.
// usage: unknown name, size, format or rate out of range; bad_input: an image that cannot be read.
Result<std::unique_ptr<CaptureSource>> make_simulated_source(const std::string& name,
                                                             const CaptureOptions& options);

// Of the frames that make_simulated_source gives for the same arguments.
Result<FrameFormat> simulated_format(const std::string& name, const CaptureOptions& options);

// The exact calibration of the camera that make_simulated_source gives for the same arguments, so that `simulated:`
// needs no calibration folder.
Result<Calibration> simulated_calibration(const std::string& name, const CaptureOptions& options);

}  // namespace lightwell
