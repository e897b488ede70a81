// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/v4l2_session.h"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <utility>

#include "daemon/capture/v4l2_frame_rate.h"
#include "daemon/clock.h"

namespace lightwell {
namespace {

// Sequence numbers of V4L2 begin at 0; above 16 bit FrameSequence takes them for plain counts.
constexpr std::uint64_t kFirstFrameId = std::uint64_t{1} << 32;
// One in the slot, two leased, one being filled: fewer and the driver would wait for us.
constexpr std::uint32_t kFewestDirectBuffers = 4;

constexpr const char* kAbsent = "is not there; check cable and power";

CaptureFault refused(const std::string& what, int error) {
  if (error == -ENODEV || error == -ENXIO) return {SourceState::no_device, kAbsent};
  return {SourceState::opening, what + ": " + errno_text(error)};
}

CaptureFault cannot_open(int error, const std::string& refusal) {
  switch (-error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
      return {SourceState::no_device, kAbsent};
    case EACCES:
    case EPERM:
      return {SourceState::opening, "may not be opened; add the user to the group video"};
    case EINVAL:
      if (!refusal.empty()) return {SourceState::opening, refusal};
      break;
    default:
      break;
  }
  return refused("cannot be opened", error);
}

std::string size_text(int width, int height) {
  return std::to_string(width) + "×" + std::to_string(height);
}

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.5g", value);
  return text.data();
}

// The format of the device to ask for: the one it has where nothing is asked and we can read it.
std::optional<V4l2Format> choose(const std::vector<std::uint32_t>& offered, std::uint32_t current,
                                 const std::string& wanted) {
  if (const auto now = v4l2_format_of(current); now && (wanted.empty() || name(now->becomes) == wanted))
    return now;
  for (const V4l2Format& format : v4l2_formats())
    if ((wanted.empty() || name(format.becomes) == wanted) &&
        std::find(offered.begin(), offered.end(), format.fourcc) != offered.end())
      return format;
  return std::nullopt;
}

CaptureFault no_format(const std::vector<std::uint32_t>& offered, const std::string& wanted) {
  std::string list;
  for (const std::uint32_t fourcc : offered) {
    list += (list.empty() ? "" : ", ") + fourcc_name(fourcc);
    if (const auto known = v4l2_format_of(fourcc)) list += " (" + std::string(name(known->becomes)) + ")";
  }
  if (list.empty()) list = "nothing";
  return {SourceState::wrong_format, wanted.empty() ? "offers " + list + "; none of them is raw codes we read"
                                                    : "pixel_format " + wanted + " is not offered; " + list +
                                                          (offered.size() == 1 ? " is" : " are")};
}

bool is_whole_picture(std::uint32_t field) {
  return field == V4L2_FIELD_NONE || field == V4L2_FIELD_ANY || field == V4L2_FIELD_INTERLACED ||
         field == V4L2_FIELD_INTERLACED_TB || field == V4L2_FIELD_INTERLACED_BT;
}

// A buffer as the ioctls want it, with its one plane where the API has planes.
struct Buffer {
  v4l2_buffer b{};
  v4l2_plane plane{};
  explicit Buffer(const V4l2Device& device, std::uint32_t index = 0) {
    b.index = index;
    b.type = device.buffer_type();
    b.memory = V4L2_MEMORY_MMAP;
    if (!device.is_multi_planar()) return;
    b.m.planes = &plane;
    b.length = 1;
  }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
};

}  // namespace

V4l2Session::V4l2Session(std::string path, V4l2Calls& calls, const CaptureOptions& options)
    : path_(std::move(path)),
      calls_(calls),
      options_(options),
      device_(calls),
      wake_fd_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}

V4l2Session::~V4l2Session() {
  close();
  verify_bug(all_returned(), "a frame lease outlived its capture source");
  unmap_all();
  if (wake_fd_ >= 0) ::close(wake_fd_);
}

void V4l2Session::remark(const std::string& words) {
  settings_.remark += (settings_.remark.empty() ? "" : "; ") + words;
}

std::optional<CaptureFault> V4l2Session::open() {
  if (const int error = device_.open(path_); error != 0) return cannot_open(error, device_.refusal());
  settings_.name = device_.card() + " (" + device_.bus() + ")";
  if (const std::string missing = device_.missing_signal(); !missing.empty())
    return CaptureFault{SourceState::no_signal, missing};
  if (!device_.follow_signal()) return CaptureFault{SourceState::opening, "another program is using it"};
  if (auto fault = agree_on_format()) return fault;
  return apply_settings();
}

std::optional<CaptureFault> V4l2Session::agree_on_format() {
  if (const int error = device_.layout(layout_); error != 0) return refused("has no format", error);
  const auto offered = device_.formats();
  const auto chosen = choose(offered, layout_.fourcc, options_.pixel_format);
  if (!chosen) return no_format(offered, options_.pixel_format);
  V4l2FrameLayout wanted = layout_;
  wanted.fourcc = chosen->fourcc;
  if (options_.width > 0) wanted.width = options_.width + 2 * chosen->first_column;
  if (options_.height > 0) wanted.height = options_.height + 2 * chosen->first_row;
  const bool as_it_is = wanted.fourcc == layout_.fourcc && wanted.width == layout_.width &&
                        wanted.height == layout_.height && is_whole_picture(layout_.field);
  if (!as_it_is) {
    layout_ = wanted;
    if (const int error = device_.set_layout(layout_); error != 0) {
      if (error == -EBUSY) return CaptureFault{SourceState::opening, "another program is using it"};
      return refused("format " + fourcc_name(wanted.fourcc) + " " + size_text(wanted.width, wanted.height),
                     error);
    }
  }
  if (layout_.fourcc != wanted.fourcc)
    return CaptureFault{SourceState::wrong_format, "format " + fourcc_name(wanted.fourcc) +
                                                       " was asked for, the device grants " +
                                                       fourcc_name(layout_.fourcc)};
  if ((options_.width > 0 && layout_.width != wanted.width) ||
      (options_.height > 0 && layout_.height != wanted.height))
    return CaptureFault{SourceState::opening, size_text(wanted.width, wanted.height) +
                                                  " was asked for, the device grants " +
                                                  size_text(layout_.width, layout_.height)};
  if (!is_whole_picture(layout_.field))
    return CaptureFault{SourceState::wrong_format, "sends the fields of a picture one by one"};
  packing_ = *chosen;
  if (layout_.stride == 0) layout_.stride = packing_.line_bytes(layout_.width);
  const FrameFormat format = packing_.frame_format(layout_.width, layout_.height);
  if (format.width <= 0 || format.height <= 0 || layout_.stride < packing_.line_bytes(layout_.width))
    return CaptureFault{SourceState::wrong_format, "says that lines of " + std::to_string(layout_.width) +
                                                       " pixels " + fourcc_name(layout_.fourcc) + " take " +
                                                       std::to_string(layout_.stride) + " bytes"};
  settings_.format = format;
  settings_.device_format = fourcc_name(layout_.fourcc);
  if (layout_.field != V4L2_FIELD_NONE && layout_.field != V4L2_FIELD_ANY) remark("interlaced");
  if (packing_.first_column != 0 || packing_.first_row != 0)
    remark("the mosaic's first " +
           std::string(packing_.first_column == 0 ? "row is"
                       : packing_.first_row == 0  ? "column is"
                                                  : "row and column are") +
           " left out, so that it begins with red");
  return std::nullopt;
}

std::optional<CaptureFault> V4l2Session::apply_settings() {
  const V4l2FrameRate rate(device_, layout_.width, layout_.height);
  if (options_.rate_hz > 0)
    if (Status status = rate.set_hz(options_.rate_hz); !status)
      return CaptureFault{SourceState::opening, status.error().message};
  settings_.rate_hz = rate.read_hz();
  // A rate off by more than a per cent was clamped, not rounded.
  if (options_.rate_hz > 0 && std::abs(settings_.rate_hz - options_.rate_hz) > 0.01 * options_.rate_hz)
    remark("asked for " + number(options_.rate_hz) + " Hz, the device grants " + number(settings_.rate_hz));
  if (Status status = device_.set(options_.controls); !status)
    return CaptureFault{SourceState::opening, status.error().message};
  if (auto fault = refuse_trigger(options_, settings_)) return fault;
  exposure_.emplace(device_, layout_.width);
  if (options_.exposure_us > 0 && exposure_->control() != 0) {
    if (Status status = exposure_->set_us(device_, options_.exposure_us); !status)
      return CaptureFault{SourceState::opening, status.error().message};
  }
  settings_.exposure_us = exposure_->read_us(device_);
  if (exposure_->control() == 0 && options_.exposure_us > 0) {
    settings_.exposure_us = options_.exposure_us;
    remark("has no exposure control; its exposure is taken as given");
  } else if (settings_.exposure_us == 0) {
    remark("does not say how long it exposes; give exposure_us");
  } else if (exposure_->is_automatic(device_)) {
    remark("exposes automatically");
  } else if (options_.exposure_us > 0 &&
             std::abs(settings_.exposure_us - options_.exposure_us) > 0.01 * options_.exposure_us) {
    remark("asked for " + number(options_.exposure_us) + " µs, the device grants " +
           number(settings_.exposure_us));
  }
  // What a step of gain does is each driver's own affair: no decibels can be told.
  for (const V4l2Control& control : device_.controls()) {
    if (control.is_hdr()) remark(control.name + " = " + std::to_string(control.value));
    if (control.is_gain())
      remark(control.name + " = " + std::to_string(control.value) + " in steps of its own");
  }
  return std::nullopt;
}

std::optional<CaptureFault> V4l2Session::start() {
  v4l2_requestbuffers request{};
  request.count = static_cast<__u32>(options_.buffers);
  request.type = device_.buffer_type();
  request.memory = V4L2_MEMORY_MMAP;
  if (const int error = device_.ioctl(VIDIOC_REQBUFS, &request); error != 0) {
    if (error == -EBUSY) return CaptureFault{SourceState::opening, "another program is using it"};
    return refused("grants no buffers", error);
  }
  if (request.count == 0) return CaptureFault{SourceState::opening, "grants no buffers"};
  if (auto fault = map_buffers(request.count)) return fault;
  if (!direct_) {
    pool_ = BufferPool::create(settings_.format.bytes(), static_cast<std::size_t>(options_.buffers));
    if (pool_ == nullptr)
      return CaptureFault{SourceState::opening, "no memory for " + std::to_string(options_.buffers) +
                                                    " frames of " + std::to_string(settings_.format.bytes()) +
                                                    " bytes"};
  }
  {
    const std::lock_guard lock(mutex_);
    returned_.reserve(direct_ ? mappings_.size() : pool_->count());
    if (!direct_)
      for (std::size_t i = 0; i < pool_->count(); ++i) returned_.push_back(i);
  }
  // Where a driver has no events, stalls and refresh find out later.
  device_.subscribe(V4L2_EVENT_SOURCE_CHANGE, 0);
  exposure_polled_ = exposure_->known() && (exposure_->is_automatic(device_) ||
                                            !device_.subscribe(V4L2_EVENT_CTRL, exposure_->control()));
  for (std::uint32_t i = 0; i < mappings_.size(); ++i)
    if (!queue(i)) return refused("takes no buffer", error_);
  int type = static_cast<int>(device_.buffer_type());
  if (const int error = device_.ioctl(VIDIOC_STREAMON, &type); error != 0) {
    if (error == -ENOLINK || error == -ENOLCK) return CaptureFault{SourceState::no_signal, errno_text(error)};
    if (error == -EBUSY) return CaptureFault{SourceState::opening, "another program is using it"};
    return refused("does not start to stream", error);
  }
  streaming_ = true;
  frame_id_ = kFirstFrameId;
  last_sequence_ = 0;
  return std::nullopt;
}

std::optional<CaptureFault> V4l2Session::map_buffers(std::uint32_t count) {
  const std::size_t needed =
      layout_.stride * static_cast<std::size_t>(layout_.height - 1) + packing_.line_bytes(layout_.width);
  std::vector<std::int64_t> offsets;
  for (std::uint32_t i = 0; i < count; ++i) {
    Buffer buffer(device_, i);
    if (const int error = device_.ioctl(VIDIOC_QUERYBUF, &buffer.b); error != 0)
      return refused("has no buffer", error);
    const bool planes = device_.is_multi_planar();
    mappings_.push_back({nullptr, planes ? buffer.plane.length : buffer.b.length});
    offsets.push_back(planes ? buffer.plane.m.mem_offset : buffer.b.m.offset);
    if (mappings_.back().bytes < needed)
      return CaptureFault{SourceState::wrong_format, "has buffers of " +
                                                         std::to_string(mappings_.back().bytes) +
                                                         " bytes for frames of " + std::to_string(needed)};
  }
  const bool ours = packing_.is_plain() && layout_.stride == packing_.line_bytes(layout_.width);
  if (ours && count >= kFewestDirectBuffers && map_exported()) {
    direct_ = true;
    return std::nullopt;
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    mappings_[i].at = static_cast<std::byte*>(calls_.map(device_.fd(), mappings_[i].bytes, offsets[i]));
    if (mappings_[i].at == nullptr)
      return CaptureFault{SourceState::opening, "has a buffer that cannot be mapped"};
  }
  return std::nullopt;
}

bool V4l2Session::map_exported() {
  for (std::uint32_t i = 0; i < mappings_.size(); ++i) {
    v4l2_exportbuffer e{};
    e.type = device_.buffer_type();
    e.index = i;
    e.flags = O_CLOEXEC | O_RDWR;
    if (device_.ioctl(VIDIOC_EXPBUF, &e) != 0) break;
    mappings_[i].at = static_cast<std::byte*>(calls_.map(e.fd, mappings_[i].bytes, 0));
    calls_.close(e.fd);  // the mapping holds the memory
    if (mappings_[i].at == nullptr) break;
  }
  if (mappings_.back().at != nullptr) return true;
  unmap_all();
  return false;
}

void V4l2Session::unmap_all() noexcept {
  for (Mapping& mapping : mappings_)
    if (mapping.at != nullptr) calls_.unmap(std::exchange(mapping.at, nullptr), mapping.bytes);
}

bool V4l2Session::queue(std::uint32_t index) noexcept {
  Buffer buffer(device_, index);
  const int error = device_.ioctl(VIDIOC_QBUF, &buffer.b);
  if (error != 0) error_ = error;
  return error == 0;
}

// Buffers of the driver that readers have given back.
bool V4l2Session::queue_returned() noexcept {
  if (!direct_) return true;
  for (;;) {
    std::size_t index = 0;
    {
      const std::lock_guard lock(mutex_);
      if (returned_.empty()) return true;
      index = returned_.back();
      returned_.pop_back();
    }
    if (!queue(static_cast<std::uint32_t>(index))) return false;
  }
}

V4l2Session::Event V4l2Session::next(std::chrono::milliseconds timeout, SessionFrame& frame) noexcept {
  if (source_changed_) return Event::source_changed;
  if (given_up_ || !queue_returned()) return Event::broken;
  const V4l2Calls::Ready ready = calls_.wait(device_.fd(), wake_fd_, static_cast<int>(timeout.count()));
  if (ready.woken) {
    std::uint64_t count = 0;
    static_cast<void>(!::read(wake_fd_, &count, sizeof count));
  }
  if (ready.event && take_events()) return Event::source_changed;
  if (!ready.frame && !ready.broken) return Event::nothing;
  const Event event = dequeue(frame);
  // Broken and nothing to dequeue: the driver will not say more.
  if (event != Event::nothing || !ready.broken) return event;
  error_ = -EIO;
  return Event::broken;
}

// True where the picture has another size or standard now.
bool V4l2Session::take_events() noexcept {
  bool changed = false;
  for (v4l2_event e{}; device_.ioctl(VIDIOC_DQEVENT, &e) == 0; e = {}) {
    if (e.type == V4L2_EVENT_SOURCE_CHANGE) changed = true;
    if (e.type == V4L2_EVENT_CTRL && exposure_ && e.id == exposure_->control() &&
        (e.u.ctrl.changes & V4L2_EVENT_CTRL_CH_VALUE) != 0)
      settings_.exposure_us = exposure_->us(e.u.ctrl.value);
  }
  return changed;
}

V4l2Session::Event V4l2Session::dequeue(SessionFrame& frame) noexcept {
  Buffer buffer(device_);
  const v4l2_buffer& b = buffer.b;
  if (const int error = device_.ioctl(VIDIOC_DQBUF, &buffer.b); error != 0) {
    if (error == -EAGAIN) return Event::nothing;
    error_ = error;
    return Event::broken;
  }
  frame = {};
  frame.received_mono_ns = mono_now_ns();
  if (b.index >= mappings_.size()) {
    error_ = -ERANGE;
    return Event::broken;
  }
  // A driver that begins to count anew goes back, which FrameSequence knows.
  frame_id_ +=
      static_cast<std::uint64_t>(std::int64_t{static_cast<std::int32_t>(b.sequence - last_sequence_)});
  last_sequence_ = b.sequence;
  frame.frame_id = frame_id_;
  frame.exposure_us = settings_.exposure_us;
  if ((b.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC) {
    frame.stamp = (b.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE
                      ? SessionFrame::Stamp::start_of_exposure
                      : SessionFrame::Stamp::end_of_frame;
    frame.t_stamp_mono_ns =
        std::int64_t{b.timestamp.tv_sec} * 1'000'000'000 + std::int64_t{b.timestamp.tv_usec} * 1000;
  }
  const bool planes = device_.is_multi_planar();
  const std::size_t begin = planes ? buffer.plane.data_offset : 0;
  const std::size_t end =
      std::min<std::size_t>(planes ? buffer.plane.bytesused : b.bytesused, mappings_[b.index].bytes);
  const std::size_t needed =
      layout_.stride * static_cast<std::size_t>(layout_.height - 1) + packing_.line_bytes(layout_.width);
  const bool whole = (b.flags & V4L2_BUF_FLAG_ERROR) == 0 && begin <= end && end - begin >= needed;
  if (whole && keep(b.index, {mappings_[b.index].at + begin, needed}, frame)) return Event::frame;
  // What has been copied is good all the same.
  given_up_ = !queue(b.index);
  return Event::frame;
}

// True where the buffer stays with the reader.
bool V4l2Session::keep(std::uint32_t index, std::span<const std::byte> bytes, SessionFrame& frame) noexcept {
  frame.outcome = SessionFrame::Outcome::complete;
  if (direct_) {
    frame.buffer = index;
    frame.bytes = bytes;
    ++out_;
    return true;
  }
  {
    const std::lock_guard lock(mutex_);
    if (returned_.empty()) {
      frame.outcome = SessionFrame::Outcome::passed_over;
      return false;
    }
    frame.buffer = returned_.back();
    returned_.pop_back();
  }
  ++out_;
  unpack_v4l2(packing_, layout_.width, layout_.height, layout_.stride, bytes, pool_->buffer(frame.buffer));
  frame.bytes = pool_->buffer(frame.buffer);
  return false;
}

CaptureFault V4l2Session::fault() const {
  if (error_ == -ENODEV || error_ == -ENXIO) return {SourceState::no_device, "is gone; looking for it"};
  return {SourceState::stalled, "broke off, opening it again: " + errno_text(error_)};
}

std::string V4l2Session::refresh() {
  if (exposure_polled_ && exposure_->known()) settings_.exposure_us = exposure_->read_us(device_);
  const std::string missing = device_.missing_signal();
  // Not every driver sends the event.
  source_changed_ = missing.empty() && !device_.is_following_signal();
  return missing;
}

Status V4l2Session::set_exposure_us(double exposure_us) {
  if (Status set = exposure_->set_us(device_, exposure_us); !set) return set;
  settings_.exposure_us = exposure_->read_us(device_);
  return {};
}

void V4l2Session::give_back(std::size_t buffer) noexcept {
  {
    const std::lock_guard lock(mutex_);
    returned_.push_back(buffer);
  }
  if (direct_) wake();
  --out_;
}

void V4l2Session::wake() noexcept {
  const std::uint64_t one = 1;
  static_cast<void>(!::write(wake_fd_, &one, sizeof one));
}

void V4l2Session::close() noexcept {
  if (device_.fd() < 0) return;
  int type = static_cast<int>(device_.buffer_type());
  if (streaming_) device_.ioctl(VIDIOC_STREAMOFF, &type);
  streaming_ = false;
  if (!direct_) unmap_all();
  // Mapped elsewhere or not, the driver lets go of them, and whoever opens the device next gets buffers.
  v4l2_requestbuffers none{};
  none.type = device_.buffer_type();
  none.memory = V4L2_MEMORY_MMAP;
  device_.ioctl(VIDIOC_REQBUFS, &none);
  device_.close();
}

}  // namespace lightwell
