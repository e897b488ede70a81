// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The input of a V4l2Device, and the signal on it: Documentation/userspace-api/media/v4l/dv-timings.rst.
#include <linux/videodev2.h>

#include <cerrno>
#include <cstring>
#include <optional>

#include "daemon/capture/v4l2_device.h"

namespace lightwell {
namespace {

std::optional<v4l2_input> input_of(const V4l2Device& device) {
  int index = 0;
  v4l2_input input{};
  if (device.ioctl(VIDIOC_G_INPUT, &index) != 0) return std::nullopt;
  input.index = static_cast<__u32>(index);
  if (device.ioctl(VIDIOC_ENUMINPUT, &input) != 0) return std::nullopt;
  return input;
}

bool has_timings(const std::optional<v4l2_input>& input) {
  return input && (input->capabilities & V4L2_IN_CAP_DV_TIMINGS) != 0;
}

// The same picture: porches and such may be measured otherwise than they are set.
bool same_picture(const v4l2_dv_timings& a, const v4l2_dv_timings& b) {
  return a.bt.width == b.bt.width && a.bt.height == b.bt.height && a.bt.interlaced == b.bt.interlaced;
}

}  // namespace

std::string V4l2Device::missing_signal() const {
  const auto input = input_of(*this);
  if (!input) return {};
  const auto* const words = reinterpret_cast<const char*>(input->name);
  const std::string where = "input " + std::string(words, ::strnlen(words, sizeof input->name));
  if ((input->status & V4L2_IN_ST_NO_POWER) != 0) return where + " has no power";
  v4l2_dv_timings there{};
  const int found = has_timings(input) ? -ioctl(VIDIOC_QUERY_DV_TIMINGS, &there) : 0;
  if (found == ERANGE) return where + " has a signal that the device cannot take";
  if (found == ENOLINK || (input->status & V4L2_IN_ST_NO_SIGNAL) != 0) return where + " has no signal";
  constexpr std::uint32_t kNoLock = V4L2_IN_ST_NO_SYNC | V4L2_IN_ST_NO_H_LOCK | V4L2_IN_ST_NO_V_LOCK;
  if (found == ENOLCK || (input->status & kNoLock) != 0) return where + " finds no lock on its signal";
  return {};
}

bool V4l2Device::is_following_signal() const {
  v4l2_dv_timings there{}, set{};
  return !has_timings(input_of(*this)) || ioctl(VIDIOC_QUERY_DV_TIMINGS, &there) != 0 ||
         ioctl(VIDIOC_G_DV_TIMINGS, &set) != 0 || same_picture(there, set);
}

bool V4l2Device::follow_signal() const {
  if (is_following_signal()) return true;
  v4l2_dv_timings there{};
  return ioctl(VIDIOC_QUERY_DV_TIMINGS, &there) != 0 || ioctl(VIDIOC_S_DV_TIMINGS, &there) != -EBUSY;
}

}  // namespace lightwell
