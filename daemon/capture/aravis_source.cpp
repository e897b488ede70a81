// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/aravis_source.h"

#include <arpa/inet.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include "daemon/capture/gvcp.h"
#include "daemon/clock.h"

namespace lightwell {
namespace {

using namespace std::chrono_literals;

constexpr auto kProbeTimeout = 150ms;  // loopback and a switch answer in one
constexpr auto kRetryAbsent = 200ms;   // a probe is one small datagram
constexpr auto kRetryRefused = 500ms;  // opening a camera is some hundred
constexpr auto kRefresh = 1s;          // exposure, gain, temperature
constexpr auto kCloseWait = 800ms;  // a live camera lets go in a tenth of this; a dead one is not waited for
constexpr auto kFirstFrameLimit = 500ms;
constexpr auto kSilenceMinimum = 150ms;  // below, a busy host would pass for a stalled camera
constexpr auto kReopenMinimum = 1s;      // the device's own heartbeat is found missing after as long

void give_lease_back(void* session, void* buffer) noexcept {
  static_cast<AravisSession*>(session)->give_back(buffer);
}

std::string summary(const CameraSettings& s) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), ": %d×%d %s, %.4g Hz%s, exposure %.4g ms, packets of %d bytes",
                s.format.width, s.format.height, std::string(name(s.format.pixel_format)).c_str(), s.rate_hz,
                s.free_running ? "" : " at most, triggered", s.exposure_us * 1e-3, s.packet_size);
  return s.name + text.data() + (s.remark.empty() ? "" : "; " + s.remark);
}

}  // namespace

AravisSource::AravisSource(std::string address, const CaptureOptions& options)
    : address_(std::move(address)), options_(options) {}

AravisSource::~AravisSource() {
  stop();
  forget_returned(true);
}

Status AravisSource::start() {
  in_addr parsed{};
  if (::inet_pton(AF_INET, address_.c_str(), &parsed) != 1) {
    return Error{ErrorKind::usage,
                 "source aravis:" + address_ + ": an IPv4 address such as aravis:192.168.0.10 is expected"};
  }
  verify_bug(!control_.joinable(), "capture source started twice");
  {
    const std::lock_guard lock(mutex_);
    stopping_ = false;
    state_ = SourceState::no_device;
    message_ = "looking for a camera at " + address_;
  }
  control_ = std::thread(&AravisSource::run, this);
  return {};
}

void AravisSource::stop() noexcept {
  if (!control_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  control_wake_.notify_all();
  control_.join();
  std::unique_lock lock(mutex_);
  closed_.wait_for(lock, kCloseWait, [&] {
    return std::all_of(retired_.begin(), retired_.end(), [](const auto& retired) { return retired->closed; });
  });
  state_ = SourceState::no_device;
  message_ = "stopped";
}

FrameLease AravisSource::wait(std::chrono::milliseconds timeout) noexcept {
  std::unique_lock lock(mutex_);
  if (!control_.joinable()) return {};
  if (!frame_ready_.wait_for(lock, timeout, [&] { return slot_.session != nullptr; })) return {};
  const Slot slot = slot_;
  slot_ = {};
  return {slot.info, slot.frame.bytes, give_lease_back, slot.session, slot.frame.buffer};
}

void AravisSource::frame_done(AravisSession& session, const ReceivedFrame& frame) noexcept {
  void* returned = frame.buffer;
  AravisSession* owner = &session;
  {
    const std::lock_guard lock(mutex_);
    if (&session == current_) {
      const auto now = Clock::now();
      // A slow camera moves its own limit; a single pause moves it by no more than a factor.
      if (first_frame_)
        period_ =
            std::max(period_ * 7 / 8, std::min<std::chrono::nanoseconds>(now - last_frame_, 4 * period_));
      last_frame_ = now;
      if (frame.outcome == ReceivedFrame::Outcome::wrong_format) {
        wrong_format_ = true;
      } else if (frame.outcome == ReceivedFrame::Outcome::incomplete) {
        ++counters_.incomplete;
        counters_.lost += sequence_.incomplete(frame.frame_id);
      } else {
        const FrameSequence::Step step = sequence_.next(frame.frame_id);
        counters_.lost += step.lost;
        ++counters_.received;
        if (!first_frame_ && delivered_before_) ++counters_.reconnects;
        first_frame_ = delivered_before_ = true;
        owner = slot_.session;
        returned = slot_.frame.buffer;
        if (owner != nullptr) ++counters_.skipped;
        slot_ = {&session, frame, frame_info(frame, step.sequence)};
        state_ = SourceState::streaming;
        frame_ready_.notify_one();
      }
    }
  }
  if (owner != nullptr) owner->give_back(returned);
}

FrameInfo AravisSource::frame_info(const ReceivedFrame& frame, std::uint64_t sequence) {
  FrameInfo info;
  info.format = settings_.format;
  info.sequence = sequence;
  info.received_mono_ns = frame.received_mono_ns;
  // Frames leave the camera when the exposure ends; read-out and wire are not known and count as nothing.
  const std::int64_t end_of_exposure =
      device_clock_.undelayed_mono_ns(frame.t_device_ns, frame.received_mono_ns);
  const auto half_exposure = static_cast<std::int64_t>(settings_.exposure_us * 500);
  info.capture_mono_ns = std::max(end_of_exposure - half_exposure, last_capture_ns_ + 1);
  last_capture_ns_ = info.capture_mono_ns;
  info.capture_utc_ns = info.capture_mono_ns + (utc_now_ns() - mono_now_ns());
  info.exposure_us = settings_.exposure_us;
  info.gain_db = settings_.gain_db;
  info.temperature_c = settings_.temperature_c;
  return info;
}

void AravisSource::control_lost(AravisSession& session) noexcept {
  const std::lock_guard lock(mutex_);
  if (&session != current_) return;
  lost_ = true;
  control_wake_.notify_all();
}

// What is wrong is said once, not at every try.
void AravisSource::report(SourceState state, const std::string& message) {
  const std::lock_guard lock(mutex_);
  state_ = state;
  if (message == message_) return;
  message_ = message;
  if (state == SourceState::streaming || state == SourceState::opening)
    spdlog::info("aravis:{}: {}", address_, message);
  else
    spdlog::warn("aravis:{}: {}", address_, message);
}

// False when stopping.
bool AravisSource::pause(std::chrono::milliseconds time) {
  std::unique_lock lock(mutex_);
  return !control_wake_.wait_for(lock, time, [&] { return stopping_; });
}

void AravisSource::run() {
  for (;;) {
    auto session = connect();
    if (session == nullptr) return;
    {
      const std::lock_guard lock(mutex_);
      session_ = std::move(session);
    }
    const Outcome outcome = watch();
    retire(outcome);
    if (outcome == Outcome::stopped) return;
  }
}

std::unique_ptr<AravisSession> AravisSource::connect() {
  for (;;) {
    forget_returned(false);
    if (!gvcp_probe(address_, kProbeTimeout)) {
      report(SourceState::no_device, "no camera answers at " + address_ + "; check cable, power and address");
      if (!pause(kRetryAbsent)) return nullptr;
      continue;
    }
    {
      // A camera that went silent is let go before it is opened anew; where it died and came back, nobody
      // waits.
      std::unique_lock lock(mutex_);
      const auto done = [&] {
        return stopping_ ||
               std::all_of(retired_.begin(), retired_.end(), [](const auto& r) { return r->closed; });
      };
      closed_.wait_for(lock, 300ms, done);
      if (stopping_) return nullptr;
      if (state_ == SourceState::no_device) state_ = SourceState::opening;
    }
    auto session = try_connect();
    if (session.ok()) return std::move(session).value();
    report(SourceState::opening, "camera at " + address_ + ": " + session.error().message);
    if (!pause(kRetryRefused)) return nullptr;
  }
}

Result<std::unique_ptr<AravisSession>> AravisSource::try_connect() {
  AravisSession::Listener& listener = *this;
  auto session = std::make_unique<AravisSession>(options_, listener);
  Status status = session->open(address_);
  if (status) {
    {
      const std::lock_guard lock(mutex_);
      current_ = session.get();
      settings_ = session->settings();
      sequence_.reconnected();
      device_clock_.reset();
      lost_ = wrong_format_ = first_frame_ = false;
      last_frame_ = Clock::now();
      period_ = std::chrono::nanoseconds(
          settings_.rate_hz > 0 ? static_cast<std::int64_t>(1e9 / settings_.rate_hz) : 1'000'000'000);
    }
    status = session->start();
  }
  if (status) {
    const std::lock_guard lock(mutex_);
    last_frame_ = std::max(last_frame_, Clock::now());
    return session;
  }
  {
    const std::lock_guard lock(mutex_);
    current_ = nullptr;
  }
  close_in_background(std::move(session), false);
  return status.error();
}

std::chrono::nanoseconds AravisSource::silence_limit() const {
  const std::chrono::nanoseconds limit = std::max<std::chrono::nanoseconds>(3 * period_, kSilenceMinimum);
  return first_frame_ ? limit : std::max<std::chrono::nanoseconds>(limit, kFirstFrameLimit);
}

AravisSource::Outcome AravisSource::watch() {
  std::unique_lock lock(mutex_);
  const std::string connected = summary(settings_);
  auto refreshed = Clock::now();
  for (;;) {
    // Half a limit finds a stall soon enough and costs nothing.
    const auto tick = std::clamp<std::chrono::nanoseconds>(silence_limit() / 2, 50ms, 500ms);
    control_wake_.wait_for(lock, tick, [&] { return stopping_ || lost_ || wrong_format_; });
    if (stopping_) return Outcome::stopped;
    if (lost_) return Outcome::lost;
    if (wrong_format_) return Outcome::wrong_format;
    const auto now = Clock::now();
    const std::chrono::nanoseconds silence = now - last_frame_;
    const bool flowing = silence < silence_limit();
    if (flowing && first_frame_) silent_sessions_ = 0;
    const auto reopen = std::max<std::chrono::nanoseconds>(10 * period_, kReopenMinimum) *
                        (1 << std::min(silent_sessions_, 2));
    if (settings_.free_running && silence > reopen) return Outcome::silent;
    lock.unlock();
    if (!settings_.free_running || (flowing && first_frame_))
      report(SourceState::streaming, connected);
    else if (!flowing)
      report(SourceState::stalled, "camera at " + address_ + " answers but sends no frames");
    if (flowing && now - refreshed > kRefresh) {
      refreshed = now;
      if (session_->refresh()) {
        const std::lock_guard again(mutex_);
        settings_ = session_->settings();
      }
    }
    session_->recycle();
    forget_returned(false);
    lock.lock();
  }
}

void AravisSource::retire(Outcome why) {
  std::unique_ptr<AravisSession> session;
  Slot left;
  {
    const std::lock_guard lock(mutex_);
    current_ = nullptr;
    session = std::move(session_);
    std::swap(left, slot_);
    if (left.session != nullptr) ++counters_.skipped;
    if (why == Outcome::silent) ++silent_sessions_;
  }
  if (left.session != nullptr) left.session->give_back(left.frame.buffer);
  if (why == Outcome::lost)
    report(SourceState::no_device, "control of the camera at " + address_ + " was lost; looking for it");
  if (why == Outcome::silent)
    report(SourceState::stalled, "camera at " + address_ + " sends no frames; opening it again");
  if (why == Outcome::wrong_format)
    report(SourceState::wrong_format,
           "frames of another size or format arrive; opening the camera at " + address_ + " again");
  close_in_background(std::move(session), why != Outcome::lost);
}

void AravisSource::close_in_background(std::unique_ptr<AravisSession> session, bool stop_camera) {
  auto retired = std::make_unique<Retired>();
  Retired* at = retired.get();
  at->session = std::move(session);
  const std::lock_guard lock(mutex_);
  at->closing = std::thread([this, at, stop_camera] {
    at->session->close(stop_camera);
    const std::lock_guard done(mutex_);
    at->closed = true;
    closed_.notify_all();
  });
  retired_.push_back(std::move(retired));
}

// Ends sessions that are closed and have all their buffers back; wait: every session, as long as it takes.
void AravisSource::forget_returned(bool wait) {
  std::vector<std::unique_ptr<Retired>> done;
  {
    const std::lock_guard lock(mutex_);
    const auto middle = std::stable_partition(retired_.begin(), retired_.end(), [&](const auto& retired) {
      return !wait && !(retired->closed && retired->session->all_returned());
    });
    std::move(middle, retired_.end(), std::back_inserter(done));
    retired_.erase(middle, retired_.end());
  }
  for (const auto& retired : done) retired->closing.join();
}

SourceState AravisSource::state() const noexcept {
  const std::lock_guard lock(mutex_);
  const bool silent =
      current_ != nullptr && settings_.free_running && Clock::now() - last_frame_ > silence_limit();
  return state_ == SourceState::streaming && silent ? SourceState::stalled : state_;
}

std::string AravisSource::describe() const {
  const std::lock_guard lock(mutex_);
  return message_;
}

CaptureCounters AravisSource::counters() const noexcept {
  const std::lock_guard lock(mutex_);
  return counters_;
}

double AravisSource::rate_hz() const noexcept {
  const std::lock_guard lock(mutex_);
  return settings_.rate_hz;
}

}  // namespace lightwell
