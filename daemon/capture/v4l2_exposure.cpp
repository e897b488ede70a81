// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/v4l2_exposure.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace lightwell {
namespace {

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

}  // namespace

V4l2Exposure::V4l2Exposure(const V4l2Device& device, int width) {
  if (device.control(V4L2_CID_EXPOSURE_ABSOLUTE)) {
    control_ = V4L2_CID_EXPOSURE_ABSOLUTE;
    us_per_unit_ = 100;
    return;
  }
  if (!device.control(V4L2_CID_EXPOSURE)) return;
  control_ = V4L2_CID_EXPOSURE;
  const auto pixels_per_s = device.value(V4L2_CID_PIXEL_RATE);
  const auto blank = device.value(V4L2_CID_HBLANK);
  if (pixels_per_s && *pixels_per_s > 0 && blank)
    us_per_unit_ = 1e6 * static_cast<double>(width + *blank) / static_cast<double>(*pixels_per_s);
}

double V4l2Exposure::read_us(const V4l2Device& device) const {
  if (!known()) return 0;
  const auto units = device.value(control_);
  return units && *units > 0 ? us(*units) : 0;
}

bool V4l2Exposure::is_automatic(const V4l2Device& device) const {
  const auto mode = device.value(V4L2_CID_EXPOSURE_AUTO);
  return mode && *mode != V4L2_EXPOSURE_MANUAL && *mode != V4L2_EXPOSURE_SHUTTER_PRIORITY;
}

Status V4l2Exposure::set_us(const V4l2Device& device, double wanted_us) const {
  const auto control = device.control(control_);
  if (!known() || !control)
    return Error{ErrorKind::failed,
                 "exposure " + number(wanted_us) + " µs: the device does not say in what units it counts"};
  const auto units =
      static_cast<std::int64_t>(std::llround(std::clamp(wanted_us / us_per_unit_, -1.0, 9e15)));
  if (units < control->minimum || units > control->maximum)
    return Error{ErrorKind::failed, "exposure " + number(wanted_us) + " µs: the device allows " +
                                        number(us(control->minimum)) + "…" + number(us(control->maximum)) +
                                        " µs"};
  if (const auto automatic = device.control(V4L2_CID_EXPOSURE_AUTO)) {
    const auto has = [&](std::int64_t mode) {
      return std::any_of(automatic->choices.begin(), automatic->choices.end(),
                         [&](const auto& choice) { return choice.first == mode; });
    };
    const int mode = has(V4L2_EXPOSURE_MANUAL) ? V4L2_EXPOSURE_MANUAL : V4L2_EXPOSURE_SHUTTER_PRIORITY;
    if (Status status = device.set(*automatic, mode); !status) return status;
  }
  // Otherwise a webcam lowers its frame rate in the dark.
  if (const auto priority = device.control(V4L2_CID_EXPOSURE_AUTO_PRIORITY); priority && priority->value != 0)
    if (Status status = device.set(*priority, 0); !status) return status;
  const std::int64_t steps = (units - control->minimum) / control->step;
  return device.set(*control, control->minimum + steps * control->step);
}

}  // namespace lightwell
