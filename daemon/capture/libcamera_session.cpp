// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/libcamera_session.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "daemon/clock.h"

namespace lightwell {
namespace {

using namespace std::chrono_literals;

// libcamera looks for cameras and sets one up; an emulated machine takes a second.
constexpr auto kAnswerLimit = 4s;
constexpr auto kPatience = 1s;  // to stop a camera
// Nodes come one by one, and udev announces them after that. A look that comes too early is in vain, and in the way of
// the next.
constexpr std::int64_t kQuietNs = 150'000'000, kLongestUnquietNs = 1'000'000'000;
constexpr std::int64_t kSettleNs = 3'000'000'000;
constexpr std::int64_t kLookAgainNs = 3'000'000'000;
constexpr auto kRetryFind = 50ms;
// One in the slot, two leased, one being filled: fewer and the camera would wait for us.
constexpr std::size_t kFewestDirectBuffers = 4;

// When a device node last came or went, or udev last had something to say of one.
std::int64_t nodes_changed() {
  std::int64_t latest = 0;
  for (const char* folder : {"/dev", "/run/udev/data"}) {
    struct stat s {};
    if (::stat(folder, &s) == 0)
      latest = std::max<std::int64_t>(latest, s.st_mtim.tv_sec * 1'000'000'000 + s.st_mtim.tv_nsec);
  }
  return latest;
}

bool readable_within(int fd, std::chrono::milliseconds time) {
  pollfd news{fd, POLLIN, 0};
  return ::poll(&news, 1, static_cast<int>(time.count())) > 0;
}

}  // namespace

LibcameraSession::LibcameraSession(std::shared_ptr<LibcameraSearch> search, std::string id,
                                   const CaptureOptions& options)
    : search_(std::move(search)),
      id_(std::move(id)),
      options_(options),
      wake_fd_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}

LibcameraSession::~LibcameraSession() {
  LibcameraSession::close();
  verify_bug(all_returned(), "a frame lease outlived its capture source");
  for (const Mapping& mapping : mappings_) ::munmap(mapping.at, mapping.bytes);
  if (wake_fd_ >= 0) ::close(wake_fd_);
}

std::optional<CaptureFault> LibcameraSession::find() {
  LibcameraSearch& search = *search_;
  const std::int64_t now = mono_now_ns(), stamp = nodes_changed();
  const std::int64_t before = std::exchange(search.nodes_stamp, stamp);
  if (stamp != before && before != 0) {
    if (now - search.changed_ns > kQuietNs) search.began_to_change_ns = now;
    search.changed_ns = now;
  }
  const std::int64_t quiet = now - search.changed_ns;
  if (quiet < kQuietNs && now - search.began_to_change_ns < kLongestUnquietNs)
    return CaptureFault{SourceState::no_device,
                        search.missing.empty() ? "is being looked for" : search.missing, kRetryFind};
  if (search.missing.empty() || quiet < kSettleNs || now - search.looked_ns > kLookAgainNs)
    return std::nullopt;
  return CaptureFault{SourceState::no_device, search.missing, kRetryFind};
}

std::optional<CaptureFault> LibcameraSession::open() {
  const nlohmann::json wish = {{"id", id_},
                               {"width", options_.width},
                               {"height", options_.height},
                               {"pixel_format", options_.pixel_format},
                               {"rate_hz", options_.rate_hz},
                               {"exposure_us", options_.exposure_us},
                               {"controls", options_.controls},
                               {"trigger", options_.trigger},
                               {"buffers", options_.buffers}};
  if (!process_.start(wish.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)))
    return CaptureFault{SourceState::opening,
                        "cannot be looked for: " + libcamera_program() + " does not start"};
  LibcameraMessage answer{};
  std::vector<int> descriptors;
  if (!readable_within(process_.socket(), kAnswerLimit))
    return CaptureFault{SourceState::opening, "cannot be looked for: libcamera does not answer"};
  if (!receive_message(process_.socket(), answer, &descriptors))
    return CaptureFault{SourceState::opening,
                        "cannot be opened: libcamera's process " + process_.how_it_ended()};
  search_->missing.clear();
  search_->looked_ns = mono_now_ns();
  std::optional<CaptureFault> fault;
  if (answer.kind == LibcameraMessage::Kind::fault) {
    fault = CaptureFault{answer.fault.state, answer.fault.message.data()};
    if (fault->state == SourceState::no_device) search_->missing = fault->message;
  } else {
    fault = map_buffers(answer.ready, descriptors);
  }
  for (const int fd : descriptors) ::close(fd);  // the mappings hold the memory
  return fault;
}

std::optional<CaptureFault> LibcameraSession::map_buffers(const LibcameraMessage::Ready& ready,
                                                          const std::vector<int>& descriptors) {
  packing_ = libcamera_format_of(ready.fourcc, ready.modifier).value_or(LibcameraFormat());
  width_ = ready.width;
  height_ = ready.height;
  stride_ = ready.stride;
  picture_bytes_ = stride_ * static_cast<std::size_t>(height_ - 1) + packing_.line_bytes(width_);
  settings_.name = ready.name.data();
  settings_.format = packing_.frame_format(width_, height_);
  settings_.device_format = ready.device_format.data();
  settings_.rate_hz = ready.rate_hz;
  settings_.exposure_us = ready.exposure_us;
  settings_.remark = ready.remark.data();
  for (std::size_t i = 0; i < std::min<std::size_t>(ready.buffers, descriptors.size()); ++i) {
    const auto& buffer = ready.buffer.at(i);
    void* at = ::mmap(nullptr, buffer.bytes, PROT_READ, MAP_SHARED, descriptors[i], 0);
    if (at == MAP_FAILED) return CaptureFault{SourceState::opening, "has a buffer that cannot be mapped"};
    mappings_.push_back({static_cast<std::byte*>(at), buffer.bytes, buffer.begin});
  }
  if (mappings_.empty()) return CaptureFault{SourceState::opening, "grants no buffers"};
  direct_ = packing_.is_plain() && stride_ == packing_.line_bytes(width_) &&
            mappings_.size() >= kFewestDirectBuffers;
  if (direct_) return std::nullopt;
  pool_ = BufferPool::create(settings_.format.bytes(), static_cast<std::size_t>(options_.buffers));
  if (pool_ == nullptr) return CaptureFault{SourceState::opening, "no memory for its frames"};
  for (std::size_t i = 0; i < pool_->count(); ++i) free_.push_back(i);
  return std::nullopt;
}

std::optional<CaptureFault> LibcameraSession::start() {
  LibcameraMessage go{};
  go.kind = LibcameraMessage::Kind::go;
  if (send_message(process_.socket(), go)) return std::nullopt;
  return CaptureFault{SourceState::opening, "does not start: libcamera's process " + process_.how_it_ended()};
}

CaptureSession::Event LibcameraSession::next(std::chrono::milliseconds timeout,
                                             SessionFrame& frame) noexcept {
  std::array<pollfd, 2> news = {{{process_.socket(), POLLIN, 0}, {wake_fd_, POLLIN, 0}}};
  if (::poll(news.data(), news.size(), static_cast<int>(timeout.count())) <= 0) return Event::nothing;
  eventfd_t count = 0;
  if (news[1].revents != 0) ::eventfd_read(wake_fd_, &count);
  if (news[0].revents == 0) return Event::nothing;
  LibcameraMessage message{};
  if (receive_message(process_.socket(), message)) return take(message, frame);
  fault_ = {SourceState::stalled,
            "broke off, opening it again: libcamera's process " + process_.how_it_ended()};
  return Event::broken;
}

CaptureSession::Event LibcameraSession::take(const LibcameraMessage& message, SessionFrame& frame) noexcept {
  if (message.kind != LibcameraMessage::Kind::frame || message.frame.buffer >= mappings_.size()) {
    fault_ = {message.fault.state, message.fault.message.data()};
    return Event::broken;
  }
  const LibcameraMessage::Frame& said = message.frame;
  frame = {};
  frame.outcome = said.outcome;
  frame.frame_id = said.frame_id;
  frame.stamp = said.stamp;
  frame.t_stamp_mono_ns = said.t_stamp_mono_ns;
  frame.received_mono_ns = said.received_mono_ns;
  frame.exposure_us = said.exposure_us;
  frame.gain_db = said.gain_db;
  settings_.exposure_us = said.exposure_us;
  settings_.rate_hz = said.rate_hz;
  if (frame.outcome == SessionFrame::Outcome::complete)
    keep(said, frame);
  else
    hand_back(said.buffer);
  return Event::frame;
}

void LibcameraSession::keep(const LibcameraMessage::Frame& said, SessionFrame& frame) noexcept {
  const Mapping& mapping = mappings_[said.buffer];
  frame.bytes = {mapping.at + mapping.begin, picture_bytes_};
  frame.buffer = said.buffer;
  if (direct_) {
    ++out_;
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    if (free_.empty())
      frame.outcome = SessionFrame::Outcome::passed_over;
    else
      frame.buffer = free_.back(), free_.pop_back();
  }
  if (frame.outcome == SessionFrame::Outcome::complete) {
    ++out_;
    unpack_libcamera(packing_, width_, height_, stride_, frame.bytes, pool_->buffer(frame.buffer));
    frame.bytes = pool_->buffer(frame.buffer);
  }
  hand_back(said.buffer);
}

void LibcameraSession::hand_back(std::uint32_t buffer) noexcept {
  LibcameraMessage message{};
  message.kind = LibcameraMessage::Kind::give_back;
  message.buffer = buffer;
  const std::lock_guard lock(mutex_);
  if (!closed_) send_message(process_.socket(), message);
}

void LibcameraSession::give_back(std::size_t buffer) noexcept {
  if (direct_) {
    hand_back(static_cast<std::uint32_t>(buffer));
  } else {
    const std::lock_guard lock(mutex_);
    free_.push_back(buffer);
  }
  --out_;
}

void LibcameraSession::wake() noexcept {
  ::eventfd_write(wake_fd_, 1);
}

void LibcameraSession::close() noexcept {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  process_.end(kPatience);
}

}  // namespace lightwell
