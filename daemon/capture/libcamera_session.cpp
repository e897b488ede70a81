// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/libcamera_session.h"

#include <dirent.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string_view>
#include <utility>

#include "daemon/capture/v4l2_device.h"
#include "daemon/clock.h"

namespace lightwell {
namespace {

namespace controls = libcamera::controls;

constexpr std::uint64_t kFirstFrameId = std::uint64_t{1}
                                        << 32;  // above 16 bit, where FrameSequence takes plain counts
// Sensors take up an exposure two frames after it is written, a gain one or two; one more for the frame under way.
constexpr std::uint64_t kControlDelayFrames = 3;
constexpr std::uint64_t kRateFrames = 8;
constexpr std::int64_t kLookAnewNs = 500'000'000;
constexpr std::int64_t kLookNs = 300'000'000;

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

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.5g", value);
  return text.data();
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

// A value in words for a control of this type; nullopt where the words are none.
std::optional<libcamera::ControlValue> parse(const libcamera::ControlId& id, const std::string& words) {
  const auto as_number = [&]<class T>(T) -> std::optional<libcamera::ControlValue> {
    T value{};
    const auto [end, error] = std::from_chars(words.data(), words.data() + words.size(), value);
    if (error != std::errc() || end != words.data() + words.size()) return std::nullopt;
    return libcamera::ControlValue(value);
  };
  switch (id.type()) {
    case libcamera::ControlTypeBool:
      if (words == "true" || words == "1") return libcamera::ControlValue(true);
      if (words == "false" || words == "0") return libcamera::ControlValue(false);
      return std::nullopt;
    case libcamera::ControlTypeInteger32:
      return as_number(std::int32_t{});
    case libcamera::ControlTypeInteger64:
      return as_number(std::int64_t{});
    case libcamera::ControlTypeFloat:
      return as_number(float{});
    default:
      return std::nullopt;
  }
}

bool within(const libcamera::ControlInfo& info, const libcamera::ControlValue& value) {
  const auto check = [&]<class T>(T) {
    return info.min().type() != value.type() || info.max().type() != value.type() ||
           (value.get<T>() >= info.min().get<T>() && value.get<T>() <= info.max().get<T>());
  };
  switch (value.type()) {
    case libcamera::ControlTypeInteger32:
      return check(std::int32_t{});
    case libcamera::ControlTypeInteger64:
      return check(std::int64_t{});
    case libcamera::ControlTypeFloat:
      return check(float{});
    default:
      return true;
  }
}

}  // namespace

std::shared_ptr<libcamera::CameraManager> libcamera_manager() {
  static std::mutex mutex;
  static std::weak_ptr<libcamera::CameraManager> shared;
  const std::lock_guard lock(mutex);
  if (auto manager = shared.lock()) return manager;
  // Its ordinary remarks would drown ours.
  ::setenv("LIBCAMERA_LOG_LEVELS", "*:ERROR", 0);
  const std::shared_ptr<libcamera::CameraManager> manager(new libcamera::CameraManager, [](auto* m) {
    m->stop();
    delete m;
  });
  if (manager->start() != 0) return nullptr;
  shared = manager;
  return manager;
}

LibcameraSession::LibcameraSession(LibcameraManagerSlot manager, std::string id,
                                   const CaptureOptions& options)
    : manager_(std::move(manager)), id_(std::move(id)), options_(options) {}

LibcameraSession::~LibcameraSession() {
  LibcameraSession::close();
  verify_bug(all_returned(), "a frame lease outlived its capture source");
  for (const Mapping& mapping : mappings_) ::munmap(mapping.at, mapping.bytes);
}

void LibcameraSession::remark(const std::string& words) {
  settings_.remark += (settings_.remark.empty() ? "" : "; ") + words;
}

std::optional<CaptureFault> LibcameraSession::open() {
  LibcameraManagerHold& hold = *manager_;
  const std::lock_guard lock(hold.mutex);
  if (hold.manager == nullptr) {
    hold.manager = libcamera_manager();
    hold.since_mono_ns = mono_now_ns();
  }
  if (hold.manager == nullptr)
    return CaptureFault{SourceState::opening, "cannot be looked for: libcamera does not start"};
  camera_ = hold.manager->get(id_);
  if (camera_ == nullptr) {
    std::string others;
    for (const auto& camera : hold.manager->cameras()) others += (others.empty() ? "" : ", ") + camera->id();
    // It hears of cameras that come, but does not take up each: now and then one begins anew.
    if (mono_now_ns() - hold.since_mono_ns > kLookAnewNs) hold.manager.reset();
    return CaptureFault{SourceState::no_device,
                        "is not there; libcamera sees " + (others.empty() ? "no camera" : others)};
  }
  if (const int error = camera_->acquire(); error != 0) {
    if (error == -EBUSY) return CaptureFault{SourceState::opening, "another program is using it"};
    return refused("cannot be taken", error);
  }
  acquired_ = true;
  vanished_before_ = vanished_nodes();
  const auto model = camera_->properties().get(libcamera::properties::Model);
  settings_.name = model ? *model : id_;
  camera_->disconnected.connect(this, &LibcameraSession::gone);
  if (auto fault = agree_on_format()) return fault;
  return choose_controls();
}

std::optional<CaptureFault> LibcameraSession::agree_on_format() {
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
  settings_.format = packing_.frame_format(width_, height_);
  settings_.device_format = asked.toString();
  if (packing_.processed)
    remark("a processed stream: its codes are what the image processor made of the sensor's");
  return std::nullopt;
}

std::optional<CaptureFault> LibcameraSession::choose_controls() {
  if (auto fault = refuse_trigger(options_, settings_)) return fault;
  const libcamera::ControlInfoMap& offered = camera_->controls();
  controls_ = libcamera::ControlList(offered);
  const auto has = [&](const libcamera::ControlId& id) { return offered.count(&id) > 0; };
  std::string rest = options_.controls;
  while (!rest.empty()) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    std::string one = rest.substr(0, comma);
    rest.erase(0, comma + 1);
    std::erase(one, ' ');
    const std::size_t equals = std::min(one.find('='), one.size());
    const auto at = std::find_if(offered.begin(), offered.end(), [&](const auto& entry) {
      return entry.first->name() == one.substr(0, equals);
    });
    if (at == offered.end() || equals == one.size()) {
      std::string names;
      for (const auto& [id, info] : offered) names += (names.empty() ? "" : ", ") + id->name();
      return CaptureFault{SourceState::opening, "control \"" + one +
                                                    "\": Name=value is expected, with one of " +
                                                    (names.empty() ? "none: it has no controls" : names)};
    }
    const auto value = parse(*at->first, one.substr(equals + 1));
    if (!value || !within(at->second, *value))
      return CaptureFault{SourceState::opening,
                          "control " + one + ": the camera allows " + at->second.toString()};
    controls_.set(at->first->id(), *value);
  }
  if (options_.rate_hz > 0) {
    if (!has(controls::FrameDurationLimits))
      return CaptureFault{SourceState::opening, "rate_hz " + number(options_.rate_hz) +
                                                    ": the camera has no frame rate to set; leave it at 0"};
    const auto period_us = static_cast<std::int64_t>(std::llround(1e6 / options_.rate_hz));
    controls_.set(controls::FrameDurationLimits, {period_us, period_us});
    settings_.rate_hz = options_.rate_hz;
  }
  if (options_.exposure_us > 0 && has(controls::ExposureTime)) {
    const libcamera::ControlInfo& range = offered.at(&controls::ExposureTime);
    const libcamera::ControlValue wanted(static_cast<std::int32_t>(std::lround(options_.exposure_us)));
    if (!within(range, wanted))
      return CaptureFault{SourceState::opening, "exposure " + number(options_.exposure_us) +
                                                    " µs: the camera allows " + range.toString() + " µs"};
    if (has(controls::AeEnable)) controls_.set(controls::AeEnable, false);
    controls_.set(controls::ExposureTime, wanted.get<std::int32_t>());
  } else if (options_.exposure_us > 0) {
    remark("has no exposure control; its exposure is taken as given");
  }
  settings_.exposure_us = options_.exposure_us;
  return std::nullopt;
}

std::optional<CaptureFault> LibcameraSession::map_buffers() {
  libcamera::Stream* stream = configuration_->at(0).stream();
  allocator_ = std::make_unique<libcamera::FrameBufferAllocator>(camera_);
  if (const int count = allocator_->allocate(stream); count <= 0) return refused("grants no buffers", count);
  const std::size_t needed = stride_ * static_cast<std::size_t>(height_ - 1) + packing_.line_bytes(width_);
  for (const auto& buffer : allocator_->buffers(stream)) {
    const libcamera::FrameBuffer::Plane& plane = buffer->planes().front();
    Mapping mapping;
    mapping.begin = plane.offset == libcamera::FrameBuffer::Plane::kInvalidOffset ? 0 : plane.offset;
    mapping.bytes = mapping.begin + plane.length;
    if (plane.length < needed)
      return CaptureFault{SourceState::wrong_format, "has buffers of " + std::to_string(plane.length) +
                                                         " bytes for frames of " + std::to_string(needed)};
    void* at = ::mmap(nullptr, mapping.bytes, PROT_READ, MAP_SHARED, plane.fd.get(), 0);
    if (at == MAP_FAILED) return CaptureFault{SourceState::opening, "has a buffer that cannot be mapped"};
    mapping.at = static_cast<std::byte*>(at);
    mappings_.push_back(mapping);
    auto request = camera_->createRequest(requests_.size());
    if (request == nullptr) return CaptureFault{SourceState::opening, "makes no request"};
    if (const int error = request->addBuffer(stream, buffer.get()); error != 0)
      return refused("takes no buffer", error);
    requests_.push_back(std::move(request));
  }
  direct_ = packing_.is_plain() && stride_ == packing_.line_bytes(width_) && mappings_.size() >= 4;
  if (direct_) return std::nullopt;
  pool_ = BufferPool::create(settings_.format.bytes(), static_cast<std::size_t>(options_.buffers));
  if (pool_ == nullptr) return CaptureFault{SourceState::opening, "no memory for its frames"};
  return std::nullopt;
}

std::optional<CaptureFault> LibcameraSession::start() {
  if (auto fault = map_buffers()) return fault;
  {
    const std::lock_guard lock(mutex_);
    done_.reserve(requests_.size());
    idle_.reserve(requests_.size());
    if (pool_ != nullptr)
      for (std::size_t i = 0; i < pool_->count(); ++i) free_.push_back(i);
  }
  frame_id_ = kFirstFrameId;
  camera_->requestCompleted.connect(this, &LibcameraSession::completed);
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

// On libcamera's thread.
void LibcameraSession::completed(libcamera::Request* request) {
  if (request->status() == libcamera::Request::RequestCancelled) return;
  const std::lock_guard lock(mutex_);
  done_.push_back(static_cast<std::size_t>(request->cookie()));
  news_.notify_one();
}

// On libcamera's thread.
void LibcameraSession::gone() {
  const std::lock_guard lock(mutex_);
  gone_ = true;
  news_.notify_one();
}

bool LibcameraSession::queue_idle() noexcept {
  for (;;) {
    std::size_t index = 0;
    {
      const std::lock_guard lock(mutex_);
      if (idle_.empty()) return true;
      index = idle_.back();
      idle_.pop_back();
    }
    requests_[index]->reuse(libcamera::Request::ReuseBuffers);
    if (const int error = camera_->queueRequest(requests_[index].get()); error != 0) {
      error_ = error;
      return false;
    }
  }
}

CaptureSession::Event LibcameraSession::next(std::chrono::milliseconds timeout,
                                             SessionFrame& frame) noexcept {
  if (!queue_idle()) return Event::broken;
  std::size_t index = 0;
  {
    std::unique_lock lock(mutex_);
    news_.wait_for(lock, timeout, [&] { return gone_ || woken_ || !done_.empty() || !idle_.empty(); });
    woken_ = false;
    if (!gone_ && done_.empty()) {
      lock.unlock();
      if (!has_vanished()) return Event::nothing;
      lock.lock();
      gone_ = true;
    }
    if (gone_) {
      error_ = -ENODEV;
      lost_ = true;
      return Event::broken;
    }
    index = done_.front();
    done_.erase(done_.begin());
  }
  heard_ns_ = mono_now_ns();
  frame = {};
  describe(*requests_[index], index, frame);
  const bool held = frame.outcome == SessionFrame::Outcome::complete && keep(index, frame);
  if (held) return Event::frame;
  const std::lock_guard lock(mutex_);
  idle_.push_back(index);
  return Event::frame;
}

// Asked now and then where nothing is heard.
bool LibcameraSession::has_vanished() noexcept {
  const std::int64_t now = mono_now_ns();
  if (now - std::max(heard_ns_, looked_ns_) < kLookNs) return false;
  looked_ns_ = now;
  return vanished_nodes() > vanished_before_;
}

void LibcameraSession::describe(libcamera::Request& request, std::size_t index,
                                SessionFrame& frame) noexcept {
  const libcamera::FrameMetadata& picture = request.buffers().begin()->second->metadata();
  const libcamera::ControlList& metadata = request.metadata();
  frame.received_mono_ns = mono_now_ns();
  frame_id_ +=
      static_cast<std::uint64_t>(std::int64_t{static_cast<std::int32_t>(picture.sequence - last_sequence_)});
  last_sequence_ = picture.sequence;
  frame.frame_id = frame_id_;
  const std::size_t needed = stride_ * static_cast<std::size_t>(height_ - 1) + packing_.line_bytes(width_);
  if (picture.status != libcamera::FrameMetadata::FrameSuccess || picture.planes().empty() ||
      picture.planes()[0].bytesused < needed)
    return;
  frame.outcome = SessionFrame::Outcome::complete;
  frame.bytes = {mappings_[index].at + mappings_[index].begin, needed};
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
  const auto exposure = metadata.get(controls::ExposureTime);
  const auto gain = metadata.get(controls::AnalogueGain);
  frame.exposure_us = exposure ? static_cast<double>(*exposure) : options_.exposure_us;
  if (gain && *gain > 0) frame.gain_db = 20 * std::log10(static_cast<double>(*gain));
  settings_.exposure_us = frame.exposure_us;
  const bool unsettled =
      !exposure && controls_.contains(controls::ExposureTime.id()) && frames_ < kControlDelayFrames;
  ++frames_;
  if (unsettled) frame.outcome = SessionFrame::Outcome::passed_over;
}

// The rate where nobody says it: over the first frames.
void LibcameraSession::measure_rate(std::int64_t t_ns, std::uint64_t frame_id) noexcept {
  if (settings_.rate_hz > 0 || t_ns == 0) return;
  if (first_ns_ == 0) {
    first_ns_ = t_ns;
    first_id_ = frame_id;
  } else if (frame_id >= first_id_ + kRateFrames && t_ns > first_ns_) {
    settings_.rate_hz =
        static_cast<double>(frame_id - first_id_) * 1e9 / static_cast<double>(t_ns - first_ns_);
  }
}

// True where the request's buffer stays with the reader.
bool LibcameraSession::keep(std::size_t index, SessionFrame& frame) noexcept {
  if (direct_) {
    frame.buffer = index;
    ++out_;
    return true;
  }
  {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) {
      frame.outcome = SessionFrame::Outcome::passed_over;
      return false;
    }
    frame.buffer = free_.back();
    free_.pop_back();
  }
  ++out_;
  unpack_libcamera(packing_, width_, height_, stride_, frame.bytes, pool_->buffer(frame.buffer));
  frame.bytes = pool_->buffer(frame.buffer);
  return false;
}

CaptureFault LibcameraSession::fault() const {
  if (error_ == -ENODEV) return {SourceState::no_device, "is gone; looking for it"};
  return {SourceState::stalled, "broke off, opening it again: " + errno_text(error_)};
}

void LibcameraSession::give_back(std::size_t buffer) noexcept {
  {
    const std::lock_guard lock(mutex_);
    (direct_ ? idle_ : free_).push_back(buffer);
    news_.notify_one();
  }
  --out_;
}

void LibcameraSession::wake() noexcept {
  const std::lock_guard lock(mutex_);
  woken_ = true;
  news_.notify_one();
}

// Whatever would speak to the device is never ended.
void LibcameraSession::abandon() noexcept {
  camera_->requestCompleted.disconnect(this);
  camera_->disconnected.disconnect(this);
  static_cast<void>(new std::shared_ptr<libcamera::Camera>(std::move(camera_)));
  camera_.reset();
  static_cast<void>(allocator_.release());
  for (auto& request : requests_) static_cast<void>(request.release());
  requests_.clear();
  configuration_.reset();
  const std::lock_guard lock(manager_->mutex);
  manager_->manager.reset();
}

void LibcameraSession::close() noexcept {
  if (camera_ == nullptr) return;
  // The node may have gone since frames were last asked for.
  if (streaming_ && (lost_ || vanished_nodes() > vanished_before_)) return abandon();
  if (streaming_) camera_->stop();  // every request comes back, cancelled
  streaming_ = false;
  camera_->requestCompleted.disconnect(this);
  camera_->disconnected.disconnect(this);
  requests_.clear();
  allocator_.reset();
  if (acquired_) camera_->release();
  acquired_ = false;
  configuration_.reset();
  camera_.reset();
}

}  // namespace lightwell
