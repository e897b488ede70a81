// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/libcamera/camera.h"

#include <dirent.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <string_view>
#include <utility>

#include "daemon/capture/v4l2_device.h"
#include "daemon/clock.h"
#include "daemon/libcamera/controls.h"

namespace lightwell {
namespace {

namespace controls = libcamera::controls;

// Above 16 bit, where FrameSequence takes plain counts.
constexpr std::uint64_t kFirstFrameId = std::uint64_t{1} << 32;
// Sensors take up an exposure two frames after it is written, a gain one or two; one more for the frame under way.
constexpr std::uint64_t kControlDelayFrames = 3;
constexpr std::uint64_t kRateFrames = 8;

// Video nodes this process has open that are no longer in the file system.
int vanished_nodes() noexcept {
  int count = 0;
  DIR* folder = ::opendir("/proc/self/fd");
  if (folder == nullptr) return 0;
  while (const dirent* entry = ::readdir(folder)) {
    std::array<char, 256> target{};
    const ssize_t size = ::readlinkat(::dirfd(folder), entry->d_name, target.data(), target.size());
    const std::string_view text(target.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
    const bool video =
        text.starts_with("/dev/video") || text.starts_with("/dev/media") || text.starts_with("/dev/v4l");
    count += video && text.ends_with(" (deleted)") ? 1 : 0;
  }
  ::closedir(folder);
  return count;
}

CaptureFault refused(const std::string& what, int error) {
  if (error == -ENODEV) return {SourceState::no_device, "is gone; looking for it"};
  return {SourceState::opening, what + ": " + errno_text(error)};
}

std::optional<LibcameraFormat> known(const libcamera::PixelFormat& format) {
  return libcamera_format_of(format.fourcc(), format.modifier());
}

// The most bits among the formats we can read that become `wanted`, raw before processed.
std::optional<libcamera::PixelFormat> choose(const std::vector<libcamera::PixelFormat>& offered,
                                             const std::string& wanted) {
  std::optional<libcamera::PixelFormat> best;
  int best_rank = 0;
  for (const libcamera::PixelFormat& format : offered) {
    const auto ours = known(format);
    if (!ours) continue;
    const PixelFormat becomes = ours->frame_format(16, 16).pixel_format;
    if (!wanted.empty() && name(becomes) != wanted) continue;
    const int rank = (ours->processed ? 0 : 1000) + 10 * significant_bits(becomes) +
                     (is_bayer(becomes) ? 2 : 0) + (ours->is_plain() ? 1 : 0);
    if (rank <= best_rank) continue;
    best = format;
    best_rank = rank;
  }
  return best;
}

}  // namespace

std::shared_ptr<libcamera::CameraManager> start_libcamera() {
  // Its ordinary remarks would drown ours.
  ::setenv("LIBCAMERA_LOG_LEVELS", "*:ERROR", 0);
  auto manager = std::make_shared<libcamera::CameraManager>();
  return manager->start() == 0 ? manager : nullptr;
}

LibcameraCamera::LibcameraCamera(std::string id, const CaptureOptions& options, OnFrame on_frame,
                                 OnGone on_gone)
    : id_(std::move(id)), options_(options), on_frame_(std::move(on_frame)), on_gone_(std::move(on_gone)) {}

LibcameraCamera::~LibcameraCamera() {
  if (camera_ == nullptr) return;
  camera_->disconnected.disconnect(this);
  if (streaming_) camera_->stop();  // every request comes back, cancelled
  camera_->requestCompleted.disconnect(this);
  requests_.clear();
  allocator_.reset();
  if (acquired_) camera_->release();
  configuration_.reset();
  camera_.reset();
  manager_->stop();
}

std::optional<CaptureFault> LibcameraCamera::open() {
  manager_ = start_libcamera();
  if (manager_ == nullptr)
    return CaptureFault{SourceState::opening, "cannot be looked for: libcamera does not start"};
  camera_ = manager_->get(id_);
  if (camera_ == nullptr) {
    std::string others;
    for (const auto& camera : manager_->cameras()) others += (others.empty() ? "" : ", ") + camera->id();
    return CaptureFault{SourceState::no_device,
                        "is not there, or another program is using it; libcamera sees " +
                            (others.empty() ? "no camera" : others)};
  }
  if (const int error = camera_->acquire(); error != 0) {
    if (error == -EBUSY) return CaptureFault{SourceState::opening, "another program is using it"};
    return refused("cannot be taken", error);
  }
  acquired_ = true;
  vanished_before_ = vanished_nodes();
  const auto model = camera_->properties().get(libcamera::properties::Model);
  settings_.name = model ? *model : id_;
  camera_->disconnected.connect(this, &LibcameraCamera::gone);
  if (auto fault = agree_on_format()) return fault;
  if (auto fault = choose_controls(camera_->controls(), options_, controls_, settings_)) return fault;
  rate_hz_ = settings_.rate_hz;
  return allocate_buffers();
}

std::optional<CaptureFault> LibcameraCamera::agree_on_format() {
  std::string list;
  for (const libcamera::StreamRole role : {libcamera::StreamRole::Raw, libcamera::StreamRole::Viewfinder}) {
    configuration_ = camera_->generateConfiguration({role});
    if (configuration_ == nullptr || configuration_->empty()) continue;
    const auto offered = configuration_->at(0).formats().pixelformats();
    const auto chosen = choose(offered, options_.pixel_format);
    if (chosen) {
      configuration_->at(0).pixelFormat = *chosen;
      break;
    }
    for (const auto& format : offered) list += (list.empty() ? "" : ", ") + format.toString();
    configuration_.reset();
  }
  if (configuration_ == nullptr)
    return CaptureFault{
        SourceState::wrong_format,
        (options_.pixel_format.empty() ? "has no stream of codes we read"
                                       : "pixel_format " + options_.pixel_format + " is not offered") +
            "; it offers " + (list.empty() ? "nothing" : list)};
  libcamera::StreamConfiguration& stream = configuration_->at(0);
  const libcamera::PixelFormat asked = stream.pixelFormat;
  packing_ = *known(asked);
  const libcamera::Size as_it_is = stream.size;
  const libcamera::Size size(
      options_.width > 0 ? static_cast<unsigned>(options_.width + 2 * packing_.codes.first_column)
                         : as_it_is.width,
      options_.height > 0 ? static_cast<unsigned>(options_.height + 2 * packing_.codes.first_row)
                          : as_it_is.height);
  stream.size = size;
  stream.bufferCount = static_cast<unsigned>(options_.buffers);
  if (configuration_->validate() == libcamera::CameraConfiguration::Invalid)
    return CaptureFault{SourceState::wrong_format, "refuses " + stream.toString()};
  if (stream.pixelFormat != asked)
    return CaptureFault{
        SourceState::wrong_format,
        "format " + asked.toString() + " was asked for, the camera grants " + stream.pixelFormat.toString()};
  if ((options_.width > 0 || options_.height > 0) && stream.size != size)
    return CaptureFault{SourceState::opening,
                        size.toString() + " was asked for, the camera grants " + stream.size.toString()};
  if (const int error = camera_->configure(configuration_.get()); error != 0)
    return refused("does not take " + stream.toString(), error);
  width_ = static_cast<int>(stream.size.width);
  height_ = static_cast<int>(stream.size.height);
  stride_ = std::max<std::size_t>(stream.stride, packing_.line_bytes(width_));
  picture_bytes_ = stride_ * static_cast<std::size_t>(height_ - 1) + packing_.line_bytes(width_);
  settings_.format = packing_.frame_format(width_, height_);
  settings_.device_format = asked.toString();
  if (packing_.processed)
    settings_.remark = "a processed stream: its codes are what the image processor made of the sensor's";
  return std::nullopt;
}

std::optional<CaptureFault> LibcameraCamera::allocate_buffers() {
  libcamera::Stream* stream = configuration_->at(0).stream();
  allocator_ = std::make_unique<libcamera::FrameBufferAllocator>(camera_);
  if (const int count = allocator_->allocate(stream); count <= 0) return refused("grants no buffers", count);
  for (const auto& buffer : allocator_->buffers(stream)) {
    if (requests_.size() == LibcameraMessage::kMostBuffers) break;
    const unsigned bytes = buffer->planes().front().length;
    if (bytes < picture_bytes_)
      return CaptureFault{SourceState::wrong_format, "has buffers of " + std::to_string(bytes) +
                                                         " bytes for frames of " +
                                                         std::to_string(picture_bytes_)};
    auto request = camera_->createRequest(requests_.size());
    if (request == nullptr) return CaptureFault{SourceState::opening, "makes no request"};
    if (const int error = request->addBuffer(stream, buffer.get()); error != 0)
      return refused("takes no buffer", error);
    requests_.push_back(std::move(request));
  }
  return std::nullopt;
}

LibcameraMessage LibcameraCamera::ready(std::vector<int>& descriptors) const {
  LibcameraMessage message{};
  message.kind = LibcameraMessage::Kind::ready;
  message.ready = {};
  LibcameraMessage::Ready& ready = message.ready;
  put_text(ready.name, settings_.name);
  put_text(ready.device_format, settings_.device_format);
  put_text(ready.remark, settings_.remark);
  ready.fourcc = packing_.fourcc;
  ready.modifier = packing_.modifier;
  ready.width = width_;
  ready.height = height_;
  ready.stride = stride_;
  ready.rate_hz = settings_.rate_hz;
  ready.exposure_us = settings_.exposure_us;
  for (const auto& request : requests_) {
    const libcamera::FrameBuffer::Plane& plane = request->buffers().begin()->second->planes().front();
    const std::uint64_t begin =
        plane.offset == libcamera::FrameBuffer::Plane::kInvalidOffset ? 0 : plane.offset;
    ready.buffer.at(ready.buffers++) = {begin, begin + plane.length};
    descriptors.push_back(plane.fd.get());
  }
  return message;
}

std::optional<CaptureFault> LibcameraCamera::start() {
  frame_id_ = kFirstFrameId;
  camera_->requestCompleted.connect(this, &LibcameraCamera::completed);
  if (const int error = camera_->start(&controls_); error != 0) {
    if (error == -EBUSY) return CaptureFault{SourceState::opening, "another program is using it"};
    return refused("does not start to stream", error);
  }
  streaming_ = true;
  for (const auto& request : requests_)
    if (const int error = camera_->queueRequest(request.get()); error != 0)
      return refused("takes no request", error);
  return std::nullopt;
}

void LibcameraCamera::queue(std::uint32_t buffer) {
  if (buffer >= requests_.size()) return;
  requests_[buffer]->reuse(libcamera::Request::ReuseBuffers);
  // One that is not taken is missed as a frame that does not come.
  static_cast<void>(camera_->queueRequest(requests_[buffer].get()));
}

void LibcameraCamera::completed(libcamera::Request* request) {
  if (request->status() == libcamera::Request::RequestCancelled) return;
  LibcameraMessage::Frame frame{};
  frame.buffer = static_cast<std::uint32_t>(request->cookie());
  describe(*request, frame);
  on_frame_(frame);
}

void LibcameraCamera::gone() {
  on_gone_();
}

bool LibcameraCamera::has_vanished() const {
  return vanished_nodes() > vanished_before_;
}

void LibcameraCamera::describe(libcamera::Request& request, LibcameraMessage::Frame& frame) {
  const libcamera::FrameMetadata& picture = request.buffers().begin()->second->metadata();
  const libcamera::ControlList& metadata = request.metadata();
  frame.received_mono_ns = mono_now_ns();
  frame_id_ +=
      static_cast<std::uint64_t>(std::int64_t{static_cast<std::int32_t>(picture.sequence - last_sequence_)});
  last_sequence_ = picture.sequence;
  frame.frame_id = frame_id_;
  frame.rate_hz = rate_hz_;
  frame.outcome = SessionFrame::Outcome::incomplete;
  if (picture.status != libcamera::FrameMetadata::FrameSuccess || picture.planes().empty() ||
      picture.planes()[0].bytesused < picture_bytes_)
    return;
  frame.outcome = SessionFrame::Outcome::complete;
  const auto sensor = metadata.get(controls::SensorTimestamp);
  const auto stamp =
      static_cast<std::int64_t>(sensor ? static_cast<std::uint64_t>(*sensor) : picture.timestamp);
  frame.stamp = sensor ? SessionFrame::Stamp::start_of_exposure : SessionFrame::Stamp::end_of_frame;
  // libcamera promises CLOCK_BOOTTIME and mostly passes on the kernel's CLOCK_MONOTONIC. They differ by the time this
  // machine slept: a stamp later than now is of the former.
  const std::int64_t slept = clock_ns(CLOCK_BOOTTIME) - mono_now_ns();
  frame.t_stamp_mono_ns = stamp > frame.received_mono_ns ? stamp - slept : stamp;
  if (stamp == 0) frame.stamp = SessionFrame::Stamp::none;
  measure_rate(stamp, frame_id_);
  frame.rate_hz = rate_hz_;
  const auto exposure = metadata.get(controls::ExposureTime);
  const auto gain = metadata.get(controls::AnalogueGain);
  frame.exposure_us = exposure ? static_cast<double>(*exposure) : options_.exposure_us;
  if (gain && *gain > 0) frame.gain_db = 20 * std::log10(static_cast<double>(*gain));
  const bool unsettled =
      !exposure && controls_.contains(controls::ExposureTime.id()) && frames_ < kControlDelayFrames;
  ++frames_;
  if (unsettled) frame.outcome = SessionFrame::Outcome::passed_over;
}

// The rate where nobody says it: over the first frames.
void LibcameraCamera::measure_rate(std::int64_t t_ns, std::uint64_t frame_id) {
  if (rate_hz_ > 0 || t_ns == 0) return;
  if (first_ns_ == 0) {
    first_ns_ = t_ns;
    first_id_ = frame_id;
  } else if (frame_id >= first_id_ + kRateFrames && t_ns > first_ns_) {
    rate_hz_ = static_cast<double>(frame_id - first_id_) * 1e9 / static_cast<double>(t_ns - first_ns_);
  }
}

}  // namespace lightwell
