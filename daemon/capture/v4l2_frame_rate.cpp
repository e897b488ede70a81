// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/v4l2_frame_rate.h"

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cmath>

namespace lightwell {

V4l2FrameRate::V4l2FrameRate(const V4l2Device& device, int width, int height)
    : device_(device), height_(height) {
  const auto pixels_per_s = device.value(V4L2_CID_PIXEL_RATE);
  const auto blank = device.value(V4L2_CID_HBLANK);
  if (pixels_per_s && *pixels_per_s > 0 && blank && *blank >= 0)
    lines_per_s_ = static_cast<double>(*pixels_per_s) / static_cast<double>(width + *blank);
}

double V4l2FrameRate::read_hz() const {
  if (const double rate_hz = device_.rate_hz(); rate_hz > 0) return rate_hz;
  const auto blank = device_.value(V4L2_CID_VBLANK);
  return blank && *blank >= 0 ? lines_per_s_ / static_cast<double>(height_ + *blank) : 0;
}

Status V4l2FrameRate::set_hz(double rate_hz) const {
  if (device_.set_rate(rate_hz)) return {};
  const auto blank = device_.control(V4L2_CID_VBLANK);
  if (lines_per_s_ == 0 || !blank || blank->read_only)
    return Error{ErrorKind::failed,
                 fmt::format("rate_hz {:.5g}: the device has no frame rate to set; leave it at 0", rate_hz)};
  const auto lines = static_cast<std::int64_t>(std::llround(std::min(lines_per_s_ / rate_hz, 1e15)));
  const std::int64_t wanted = lines - height_;
  if (wanted < blank->minimum || wanted > blank->maximum)
    return Error{ErrorKind::failed,
                 fmt::format("rate_hz {:.5g}: the device allows {:.5g}…{:.5g} Hz", rate_hz,
                             lines_per_s_ / static_cast<double>(height_ + blank->maximum),
                             lines_per_s_ / static_cast<double>(height_ + blank->minimum))};
  const std::int64_t steps = (wanted - blank->minimum) / blank->step;
  return device_.set(*blank, blank->minimum + steps * blank->step);
}

}  // namespace lightwell
