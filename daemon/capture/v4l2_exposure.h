// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "daemon/capture/v4l2_device.h"
#include "lighting/result.h"

namespace lightwell {

// Exposure time in µs of a device that counts it in units: 100 µs each of V4L2_CID_EXPOSURE_ABSOLUTE (webcams), or
// lines each of V4L2_CID_EXPOSURE (raw sensors), whose length follows from the sensor's pixel rate and blanking.
class V4l2Exposure {
 public:
  // width: of the frames, for the length of a line
  V4l2Exposure(const V4l2Device& device, int width);
  // The device has an exposure, and says in what units.
  [[nodiscard]] bool known() const { return us_per_unit_ > 0; }
  [[nodiscard]] std::uint32_t control() const { return control_; }
  [[nodiscard]] double us(std::int64_t units) const { return static_cast<double>(units) * us_per_unit_; }
  // Now; 0 where it is not known.
  [[nodiscard]] double read_us(const V4l2Device& device) const;
  // Ends automatic exposure first. failed: out of the device's range, which is named in µs.
  Status set_us(const V4l2Device& device, double wanted_us) const;
  [[nodiscard]] bool is_automatic(const V4l2Device& device) const;

 private:
  std::uint32_t control_ = 0;
  double us_per_unit_ = 0;
};

}  // namespace lightwell
