// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/v4l2_device.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>

namespace lightwell {
namespace {

// Fixed-size text of the driver, which need not end.
template <std::size_t size>
std::string text(const __u8 (&field)[size]) {
  const auto* begin = reinterpret_cast<const char*>(field);
  return {begin, ::strnlen(begin, size)};
}

double hertz(const v4l2_fract& period) {
  return period.numerator > 0 ? static_cast<double>(period.denominator) / period.numerator : 0;
}

}  // namespace

std::string errno_text(int error) {
  const int number = error < 0 ? -error : error;
  const char* name = ::strerrorname_np(number);
  return std::string(::strerror(number)) + " (" + (name != nullptr ? name : std::to_string(number)) + ")";
}

bool V4l2Device::is_multi_planar() const noexcept {
  return type_ == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
}

int V4l2Device::open(const std::string& path) {
  refusal_.clear();
  fd_ = calls_.open(path.c_str());
  if (fd_ < 0) return fd_;
  v4l2_capability c{};
  int error = ioctl(VIDIOC_QUERYCAP, &c);
  if (error == -ENOTTY || error == -EINVAL) {
    refusal_ = "is not a V4L2 device";
    error = -EINVAL;
  }
  if (error == 0) {
    card_ = text(c.card);
    driver_ = text(c.driver);
    bus_ = text(c.bus_info);
    const std::uint32_t can = (c.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? c.device_caps : c.capabilities;
    type_ = 0;
    if ((can & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0) type_ = V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
    if ((can & V4L2_CAP_VIDEO_CAPTURE) != 0) type_ = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (type_ == 0)
      refusal_ = "captures no video (" + card_ + ")";
    else if ((can & V4L2_CAP_STREAMING) == 0)
      refusal_ = "does not stream (" + card_ + ")";
    if (!refusal_.empty()) error = -EINVAL;
  }
  if (error != 0) close();
  return error;
}

void V4l2Device::close() noexcept {
  if (fd_ >= 0) calls_.close(fd_);
  fd_ = -1;
}

std::vector<std::uint32_t> V4l2Device::formats() const {
  std::vector<std::uint32_t> list;
  v4l2_fmtdesc d{};
  for (d.type = type_; ioctl(VIDIOC_ENUM_FMT, &d) == 0; ++d.index) list.push_back(d.pixelformat);
  return list;
}

std::vector<V4l2FormatDescription> V4l2Device::describe_formats() const {
  std::vector<V4l2FormatDescription> list;
  v4l2_fmtdesc d{};
  for (d.type = type_; ioctl(VIDIOC_ENUM_FMT, &d) == 0; ++d.index)
    list.push_back({d.pixelformat, text(d.description), sizes(d.pixelformat)});
  return list;
}

std::vector<V4l2Size> V4l2Device::sizes(std::uint32_t fourcc) const {
  std::vector<V4l2Size> list;
  v4l2_frmsizeenum s{};
  for (s.pixel_format = fourcc; ioctl(VIDIOC_ENUM_FRAMESIZES, &s) == 0; ++s.index) {
    V4l2Size size;
    const auto as_int = [](__u32 v) { return static_cast<int>(std::min<__u32>(v, 1U << 30)); };
    if (s.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
      size.width = size.largest_width = as_int(s.discrete.width);
      size.height = size.largest_height = as_int(s.discrete.height);
    } else {
      size.width = as_int(s.stepwise.min_width);
      size.height = as_int(s.stepwise.min_height);
      size.largest_width = as_int(s.stepwise.max_width);
      size.largest_height = as_int(s.stepwise.max_height);
    }
    v4l2_frmivalenum r{};
    r.pixel_format = fourcc;
    r.width = static_cast<__u32>(size.largest_width);
    r.height = static_cast<__u32>(size.largest_height);
    const auto add = [&](double rate_hz) {
      if (!(rate_hz > 0)) return;
      size.rate_min_hz = size.rate_min_hz > 0 ? std::min(size.rate_min_hz, rate_hz) : rate_hz;
      size.rate_max_hz = std::max(size.rate_max_hz, rate_hz);
    };
    for (; ioctl(VIDIOC_ENUM_FRAMEINTERVALS, &r) == 0; ++r.index) {
      if (r.type == V4L2_FRMIVAL_TYPE_DISCRETE) {
        add(hertz(r.discrete));
        continue;
      }
      add(hertz(r.stepwise.min));
      add(hertz(r.stepwise.max));
      break;
    }
    list.push_back(size);
    if (s.type != V4L2_FRMSIZE_TYPE_DISCRETE) break;
  }
  return list;
}

namespace {

V4l2FrameLayout layout_of(const v4l2_format& f, bool multi_planar) {
  if (!multi_planar) {
    const v4l2_pix_format& p = f.fmt.pix;
    return {static_cast<int>(p.width),
            static_cast<int>(p.height),
            p.pixelformat,
            p.field,
            p.bytesperline,
            p.sizeimage};
  }
  const v4l2_pix_format_mplane& p = f.fmt.pix_mp;
  return {static_cast<int>(p.width),   static_cast<int>(p.height), p.pixelformat, p.field,
          p.plane_fmt[0].bytesperline, p.plane_fmt[0].sizeimage};
}

}  // namespace

int V4l2Device::layout(V4l2FrameLayout& out) const {
  v4l2_format f{};
  f.type = type_;
  const int error = ioctl(VIDIOC_G_FMT, &f);
  if (error == 0) out = layout_of(f, is_multi_planar());
  return error;
}

int V4l2Device::set_layout(V4l2FrameLayout& wanted) const {
  v4l2_format f{};
  f.type = type_;
  // From what is in force, so that colour and such stay as they are.
  int error = ioctl(VIDIOC_G_FMT, &f);
  if (error != 0) return error;
  if (is_multi_planar()) {
    v4l2_pix_format_mplane& p = f.fmt.pix_mp;
    p.width = static_cast<__u32>(wanted.width);
    p.height = static_cast<__u32>(wanted.height);
    p.pixelformat = wanted.fourcc;
    p.field = V4L2_FIELD_NONE;
    p.num_planes = 1;
    p.plane_fmt[0].bytesperline = p.plane_fmt[0].sizeimage = 0;
  } else {
    v4l2_pix_format& p = f.fmt.pix;
    p.width = static_cast<__u32>(wanted.width);
    p.height = static_cast<__u32>(wanted.height);
    p.pixelformat = wanted.fourcc;
    p.field = V4L2_FIELD_NONE;
    p.bytesperline = p.sizeimage = 0;
  }
  error = ioctl(VIDIOC_S_FMT, &f);
  if (error == 0) wanted = layout_of(f, is_multi_planar());
  return error;
}

double V4l2Device::rate_hz() const {
  v4l2_streamparm p{};
  p.type = type_;
  if (ioctl(VIDIOC_G_PARM, &p) != 0) return 0;
  return hertz(p.parm.capture.timeperframe);
}

bool V4l2Device::set_rate(double rate_hz) const {
  v4l2_streamparm p{};
  p.type = type_;
  if (ioctl(VIDIOC_G_PARM, &p) != 0 || (p.parm.capture.capability & V4L2_CAP_TIMEPERFRAME) == 0) return false;
  // Whole rates exactly; 29.97 as 1000/29970.
  const bool whole = rate_hz == std::floor(rate_hz);
  p.parm.capture.timeperframe.numerator = whole ? 1 : 1000;
  p.parm.capture.timeperframe.denominator = static_cast<__u32>(std::lround(whole ? rate_hz : rate_hz * 1000));
  return ioctl(VIDIOC_S_PARM, &p) == 0;
}

bool V4l2Device::subscribe(std::uint32_t event, std::uint32_t id) const noexcept {
  v4l2_event_subscription s{};
  s.type = event;
  s.id = id;
  return ioctl(VIDIOC_SUBSCRIBE_EVENT, &s) == 0;
}

}  // namespace lightwell
