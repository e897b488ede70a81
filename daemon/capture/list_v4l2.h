// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "daemon/capture/v4l2_device.h"

namespace lightwell {

// What a V4L2 capture device is and can do, in the driver's words.
struct V4l2Description {
  std::string path, card, driver, bus;
  std::string unavailable;  // why the rest is empty: rights, busy; usually empty
  std::string missing_signal;
  V4l2FrameLayout layout;  // as set now
  double rate_hz = 0;      // as set now, 0 where the driver has none
  std::vector<V4l2FormatDescription> formats;
  std::vector<V4l2Control> controls;
};

// Nodes video0, video1, … of a folder that capture video; others, such as those that carry metadata, are left out.
// Opens each for a moment and changes nothing.
std::vector<V4l2Description> list_v4l2(const std::string& folder = "/dev",
                                       V4l2Calls& calls = system_v4l2_calls());

}  // namespace lightwell
