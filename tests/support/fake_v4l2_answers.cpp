// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// What the fake driver answers to each ioctl; called with its mutex held.
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "tests/support/fake_v4l2.h"

namespace lightwell::test {
namespace {

template <class Text, std::size_t size>
void put(Text (&field)[size], const std::string& text) {
  std::memset(field, 0, size);
  std::memcpy(field, text.data(), std::min(text.size(), size - 1));
}

}  // namespace

int FakeV4l2::answer(File& file, unsigned long request, void* argument) {
  switch (request) {
    case VIDIOC_QUERYCAP: {
      auto& c = *static_cast<v4l2_capability*>(argument);
      put(c.driver, "fake");
      put(c.card, "Fake camera");
      put(c.bus_info, "test:0");
      c.device_caps =
          V4L2_CAP_STREAMING | (model_.multi_planar ? V4L2_CAP_VIDEO_CAPTURE_MPLANE : V4L2_CAP_VIDEO_CAPTURE);
      c.capabilities = c.device_caps | V4L2_CAP_DEVICE_CAPS;
      return 0;
    }
    case VIDIOC_G_INPUT:
      *static_cast<int*>(argument) = 0;
      return 0;
    case VIDIOC_ENUMINPUT: {
      auto& i = *static_cast<v4l2_input*>(argument);
      put(i.name, "HDMI 0");
      i.status = input_status_;
      i.capabilities = model_.dv_timings ? V4L2_IN_CAP_DV_TIMINGS : 0;
      return i.index == 0 ? 0 : -EINVAL;
    }
    case VIDIOC_QUERY_DV_TIMINGS:
    case VIDIOC_G_DV_TIMINGS:
    case VIDIOC_S_DV_TIMINGS:
      return answer_timings(request, argument);
    case VIDIOC_SUBSCRIBE_EVENT: {
      const auto& s = *static_cast<v4l2_event_subscription*>(argument);
      file.subscribed.emplace_back(s.type, s.id);
      return 0;
    }
    case VIDIOC_DQEVENT:
      if (file.events.empty()) return -ENOENT;
      *static_cast<v4l2_event*>(argument) = file.events.front();
      file.events.pop_front();
      return 0;
    case VIDIOC_QUERY_EXT_CTRL:
    case VIDIOC_QUERYMENU:
    case VIDIOC_G_EXT_CTRLS:
    case VIDIOC_S_EXT_CTRLS:
      return answer_controls(request, argument);
    case VIDIOC_REQBUFS:
    case VIDIOC_QUERYBUF:
    case VIDIOC_EXPBUF:
    case VIDIOC_QBUF:
    case VIDIOC_DQBUF:
    case VIDIOC_STREAMON:
    case VIDIOC_STREAMOFF:
      return answer_buffers(file, request, argument);
    default:
      return answer_formats(file, request, argument);
  }
}

int FakeV4l2::answer_timings(unsigned long request, void* argument) {
  auto& bt = static_cast<v4l2_dv_timings*>(argument)->bt;
  if (!model_.dv_timings) return -ENOTTY;
  if (request == VIDIOC_S_DV_TIMINGS) {
    for (const auto& [fd, other] : files_)
      if (!other.buffers.empty()) return -EBUSY;
    model_.width = static_cast<int>(bt.width);
    model_.height = static_cast<int>(bt.height);
    return 0;
  }
  const bool set = request == VIDIOC_G_DV_TIMINGS;
  if (!set && signal_error_ != 0) return -signal_error_;
  const int width = set || signal_width_ == 0 ? model_.width : signal_width_;
  const int height = set || signal_height_ == 0 ? model_.height : signal_height_;
  bt.width = static_cast<__u32>(width);
  bt.height = static_cast<__u32>(height);
  return 0;
}

void FakeV4l2::fill(v4l2_format& format) const {
  const auto width = static_cast<__u32>(model_.width), height = static_cast<__u32>(model_.height);
  const auto line = static_cast<__u32>(stride()), image = static_cast<__u32>(size_image());
  if (model_.multi_planar) {
    auto& p = format.fmt.pix_mp;
    p.width = width;
    p.height = height;
    p.pixelformat = fourcc_;
    p.field = V4L2_FIELD_NONE;
    p.num_planes = 1;
    p.plane_fmt[0].bytesperline = line;
    p.plane_fmt[0].sizeimage = image;
    return;
  }
  auto& p = format.fmt.pix;
  p.width = width;
  p.height = height;
  p.pixelformat = fourcc_;
  p.field = V4L2_FIELD_NONE;
  p.bytesperline = line;
  p.sizeimage = image;
}

int FakeV4l2::answer_formats(File& file, unsigned long request, void* argument) {
  switch (request) {
    case VIDIOC_ENUM_FMT: {
      auto& d = *static_cast<v4l2_fmtdesc*>(argument);
      if (d.type != type() || d.index >= model_.formats.size()) return -EINVAL;
      d.pixelformat = model_.formats[d.index];
      put(d.description, "format " + std::to_string(d.index));
      return 0;
    }
    case VIDIOC_ENUM_FRAMESIZES: {
      auto& s = *static_cast<v4l2_frmsizeenum*>(argument);
      if (s.index > 0) return -EINVAL;
      s.type = V4L2_FRMSIZE_TYPE_STEPWISE;
      s.stepwise = {16, static_cast<__u32>(model_.largest_width),  2,
                    16, static_cast<__u32>(model_.largest_height), 2};
      return 0;
    }
    case VIDIOC_ENUM_FRAMEINTERVALS: {
      auto& r = *static_cast<v4l2_frmivalenum*>(argument);
      constexpr std::array<__u32, 2> kRates = {25, 100};
      if (r.index >= kRates.size()) return -EINVAL;
      r.type = V4L2_FRMIVAL_TYPE_DISCRETE;
      r.discrete = {1, kRates[r.index]};
      return 0;
    }
    case VIDIOC_G_FMT: {
      auto& f = *static_cast<v4l2_format*>(argument);
      if (f.type != type()) return -EINVAL;
      fill(f);
      return 0;
    }
    case VIDIOC_S_FMT: {
      auto& f = *static_cast<v4l2_format*>(argument);
      if (f.type != type()) return -EINVAL;
      for (const auto& [fd, other] : files_)
        if (!other.buffers.empty()) return -EBUSY;
      const bool planes = model_.multi_planar;
      const __u32 fourcc = planes ? f.fmt.pix_mp.pixelformat : f.fmt.pix.pixelformat;
      // As drivers do: the nearest they can.
      model_.width = std::clamp(static_cast<int>(planes ? f.fmt.pix_mp.width : f.fmt.pix.width), 16,
                                model_.largest_width);
      model_.height = std::clamp(static_cast<int>(planes ? f.fmt.pix_mp.height : f.fmt.pix.height), 16,
                                 model_.largest_height);
      const auto& all = model_.formats;
      fourcc_ = std::find(all.begin(), all.end(), fourcc) != all.end() ? fourcc : all.front();
      fill(f);
      return 0;
    }
    case VIDIOC_G_PARM:
    case VIDIOC_S_PARM: {
      auto& p = static_cast<v4l2_streamparm*>(argument)->parm.capture;
      if (!model_.has_rate) return -ENOTTY;
      if (request == VIDIOC_S_PARM)
        model_.rate_hz = std::clamp(
            static_cast<double>(p.timeperframe.denominator) / p.timeperframe.numerator, 1.0, 200.0);
      p.capability = V4L2_CAP_TIMEPERFRAME;
      p.timeperframe = {1000, static_cast<__u32>(std::lround(1000 * model_.rate_hz))};
      return 0;
    }
    default:
      static_cast<void>(file);
      return -ENOTTY;
  }
}

int FakeV4l2::answer_controls(unsigned long request, void* argument) {
  auto& controls = model_.controls;
  if (request == VIDIOC_QUERY_EXT_CTRL) {
    auto& q = *static_cast<v4l2_query_ext_ctrl*>(argument);
    constexpr std::uint32_t kNext = V4L2_CTRL_FLAG_NEXT_CTRL | V4L2_CTRL_FLAG_NEXT_COMPOUND;
    const auto at = (q.id & kNext) != 0 ? controls.upper_bound(q.id & ~kNext) : controls.find(q.id);
    if (at == controls.end()) return -EINVAL;
    const auto& c = at->second;
    q = {};
    q.id = at->first;
    q.type = c.type;
    put(q.name, c.name);
    q.minimum = c.minimum;
    q.maximum = c.maximum;
    q.step = static_cast<__u64>(c.step);
    q.default_value = c.minimum;
    q.flags = c.flags;
    return 0;
  }
  if (request == VIDIOC_QUERYMENU) {
    auto& m = *static_cast<v4l2_querymenu*>(argument);
    const auto& c = controls.at(m.id);
    const auto i = static_cast<std::size_t>(m.index - c.minimum);
    if (i >= c.menu.size() || c.menu[i].empty()) return -EINVAL;
    std::memset(m.name, 0, sizeof m.name);
    std::memcpy(m.name, c.menu[i].data(), std::min(c.menu[i].size(), sizeof m.name - 1));
    return 0;
  }
  auto& list = *static_cast<v4l2_ext_controls*>(argument);
  v4l2_ext_control& x = *list.controls;
  const auto at = controls.find(x.id);
  if (list.count != 1 || at == controls.end()) return -EINVAL;
  auto& c = at->second;
  const bool wide = c.type == V4L2_CTRL_TYPE_INTEGER64;
  if (request == VIDIOC_G_EXT_CTRLS) {
    if (wide)
      x.value64 = c.value;
    else
      x.value = static_cast<__s32>(c.value);
    return 0;
  }
  const std::int64_t value = wide ? x.value64 : x.value;
  if ((c.flags & V4L2_CTRL_FLAG_READ_ONLY) != 0) return -EACCES;
  if (value < c.minimum || value > c.maximum) return -ERANGE;
  c.value = value;
  return 0;
}

int FakeV4l2::answer_buffers(File& file, unsigned long request, void* argument) {
  switch (request) {
    case VIDIOC_REQBUFS: {
      auto& r = *static_cast<v4l2_requestbuffers*>(argument);
      for (const auto& [fd, other] : files_)
        if (&other != &file && !other.buffers.empty()) return -EBUSY;
      if (file.streaming) return -EBUSY;
      free_buffers(file);
      for (std::uint32_t i = 0; i < r.count; ++i) {
        Buffer buffer;
        buffer.memory_fd = ::memfd_create("fake-v4l2", MFD_CLOEXEC);
        if (::ftruncate(buffer.memory_fd, static_cast<off_t>(buffer_bytes())) != 0) return -ENOMEM;
        buffer.memory = static_cast<std::byte*>(
            ::mmap(nullptr, buffer_bytes(), PROT_READ | PROT_WRITE, MAP_SHARED, buffer.memory_fd, 0));
        buffer.bytes = buffer_bytes();
        file.buffers.push_back(buffer);
      }
      return 0;
    }
    case VIDIOC_STREAMON:
      if (file.buffers.empty()) return -EINVAL;
      file.streaming = true;
      file.broken = false;
      return 0;
    case VIDIOC_STREAMOFF:
      file.streaming = file.broken = false;
      file.queue.clear();
      file.done.clear();
      for (Buffer& buffer : file.buffers) buffer.queued = false;
      return 0;
    case VIDIOC_EXPBUF: {
      auto& e = *static_cast<v4l2_exportbuffer*>(argument);
      if (!model_.exports) return -ENOTTY;
      if (e.type != type() || e.index >= file.buffers.size()) return -EINVAL;
      e.fd = ::dup(file.buffers[e.index].memory_fd);
      return 0;
    }
    default:
      break;
  }
  auto& b = *static_cast<v4l2_buffer*>(argument);
  if (b.type != type() || b.memory != V4L2_MEMORY_MMAP) return -EINVAL;
  if (model_.multi_planar && (b.length < 1 || b.m.planes == nullptr)) return -EINVAL;
  if (request == VIDIOC_DQBUF) {
    if (!file.streaming) return -EINVAL;
    if (file.broken) return -EIO;
    if (file.done.empty()) return -EAGAIN;
    const Done done = file.done.front();
    file.done.pop_front();
    file.buffers[done.index].queued = false;
    b.index = done.index;
    b.flags = done.flags;
    b.sequence = done.sequence;
    b.timestamp = {done.stamp_ns / 1'000'000'000, done.stamp_ns % 1'000'000'000 / 1000};
    (model_.multi_planar ? b.m.planes->bytesused : b.bytesused) = done.bytes;
    return 0;
  }
  if (b.index >= file.buffers.size()) return -EINVAL;
  if (request == VIDIOC_QBUF) {
    if (file.buffers[b.index].queued) return -EINVAL;
    file.buffers[b.index].queued = true;
    file.queue.push_back(b.index);
    return 0;
  }
  const auto length = static_cast<__u32>(buffer_bytes());
  const auto offset = static_cast<__u32>(b.index * buffer_bytes());
  if (model_.multi_planar) {
    b.m.planes->length = length;
    b.m.planes->m.mem_offset = offset;
  } else {
    b.length = length;
    b.m.offset = offset;
  }
  return 0;
}

}  // namespace lightwell::test
