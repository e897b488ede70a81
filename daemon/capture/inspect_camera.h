// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lighting/result.h"

namespace lightwell {

// What a GigE Vision camera can do, in its own words.
struct CameraCapabilities {
  int width = 0, height = 0;  // as set now
  int sensor_width = 0, sensor_height = 0;
  std::string pixel_format;  // as set now
  std::vector<std::string> pixel_formats;
  double rate_hz = 0;  // 0 where the camera does not say, as below
  double rate_min_hz = 0, rate_max_hz = 0;
  double exposure_us = 0;
};

// Opens the camera for a moment and changes nothing. A camera that another program controls is left alone:
// failed. Takes milliseconds, up to 8 s where the camera dies meanwhile.
Result<CameraCapabilities> inspect_camera(const std::string& address);

}  // namespace lightwell
