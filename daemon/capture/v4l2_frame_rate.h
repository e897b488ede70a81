// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/capture/v4l2_device.h"
#include "lighting/result.h"

namespace lightwell {

// Frame rate of a device: by VIDIOC_S_PARM (webcams), or, on raw sensors, by how long the lines and columns are in which
// they read out: rate = pixel rate / ((width + horizontal blanking) · (height + vertical blanking)), all of them
// controls (Documentation/userspace-api/media/drivers/camera-sensor.rst, "Frame interval configuration").
class V4l2FrameRate {
 public:
  // width, height: of the frames
  V4l2FrameRate(const V4l2Device& device, int width, int height);
  // Now; 0 where it is not known.
  [[nodiscard]] double read_hz() const;
  // Sets the nearest that the device has. failed: it has none, or it is out of a sensor's range, which is named.
  [[nodiscard]] Status set_hz(double rate_hz) const;

 private:
  const V4l2Device& device_;
  int height_;
  double lines_per_s_ = 0;  // of a raw sensor; 0: not known
};

}  // namespace lightwell
