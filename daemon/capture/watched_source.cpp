// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/watched_source.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "daemon/clock.h"

namespace lightwell {
namespace {

using namespace std::chrono_literals;

constexpr auto kRetry = 200ms;  // where a device fails at its first frame
// Until an exposure that was changed is that of a frame: sensors take it up two frames later, one is under way.
constexpr int kExposureDelayFrames = 3;
constexpr auto kLookAround = 500ms;  // signal and automatic exposure
constexpr auto kTick = 100ms;        // a stall is found this late at most
constexpr auto kFirstFrameLimit = 500ms;
constexpr auto kSilenceMinimum = 150ms;  // below, a busy host would pass for a stalled camera
constexpr auto kReopenMinimum = 1s;
// A live device lets go in a tenth of a second; a dead one is not waited for.
constexpr auto kCloseWait = 300ms;
constexpr auto kCloseWaitAtEnd = 800ms;  // whoever opens it next finds it free

struct Token {
  static void* of(std::size_t buffer) { return reinterpret_cast<void*>(buffer); }
  static std::size_t buffer(void* token) { return reinterpret_cast<std::size_t>(token); }
};

void give_lease_back(void* session, void* token) noexcept {
  static_cast<CaptureSession*>(session)->give_back(Token::buffer(token));
}

const char* words(SessionFrame::Stamp stamp) {
  switch (stamp) {
    case SessionFrame::Stamp::start_of_exposure:
      return "stamped at the start of the exposure";
    case SessionFrame::Stamp::end_of_frame:
      return "stamped at the end of the frame";
    case SessionFrame::Stamp::mapped:
      return "stamped by its own clock";
    case SessionFrame::Stamp::none:
      break;
  }
  return "without stamps in our clock, times are of reception";
}

std::string summary(const SessionSettings& s, SessionFrame::Stamp stamp) {
  const std::string pixel_format(name(s.format.pixel_format));
  std::string out = fmt::format("{}: {}×{} {}", s.name, s.format.width, s.format.height, pixel_format);
  if (!s.device_format.empty() && s.device_format != pixel_format) out += " from " + s.device_format;
  out += fmt::format(", {:.4g} Hz{}, exposure {:.4g} ms", s.rate_hz, s.free_running ? "" : " at most",
                     s.exposure_us * 1e-3);
  if (!s.free_running) out += ", " + (s.trigger.empty() ? std::string("triggered") : s.trigger);
  out += std::string(", ") + words(stamp);
  if (!s.clock.empty()) out += " (" + s.clock + ")";
  return s.remark.empty() ? out : out + "; " + s.remark;
}

}  // namespace

WatchedSource::WatchedSource(std::string kind, std::string what, Connect connect, Status refusal)
    : kind_(std::move(kind)),
      what_(std::move(what)),
      make_session_(std::move(connect)),
      refusal_(std::move(refusal)) {}

WatchedSource::~WatchedSource() {
  stop();
  for (const Retired& retired : retired_) retired.closed.wait();
}

Status WatchedSource::start() {
  if (!refusal_) return refusal_;
  verify_bug(!thread_.joinable(), "capture source started twice");
  {
    const std::lock_guard lock(mutex_);
    stopping_ = false;
    state_ = SourceState::no_device;
    message_ = "looking for " + what_;
  }
  thread_ = std::thread(&WatchedSource::run, this);
  return {};
}

void WatchedSource::stop() noexcept {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    if (current_ != nullptr) current_->wake();
  }
  wake_.notify_all();
  thread_.join();
  wait_for_closing(kCloseWaitAtEnd);
  const std::lock_guard lock(mutex_);
  state_ = SourceState::no_device;
  message_ = "stopped";
}

FrameLease WatchedSource::wait(std::chrono::milliseconds timeout) noexcept {
  std::unique_lock lock(mutex_);
  if (!thread_.joinable()) return {};
  if (!frame_ready_.wait_for(lock, timeout, [&] { return slot_.session != nullptr; })) return {};
  const Slot slot = std::exchange(slot_, {});
  return {slot.info, slot.frame.bytes, give_lease_back, slot.session, Token::of(slot.frame.buffer)};
}

// What is wrong is said once, not at every try.
void WatchedSource::report(SourceState state, const std::string& message) {
  const std::lock_guard lock(mutex_);
  state_ = state;
  if (message == message_) return;
  message_ = message;
  if (state == SourceState::streaming)
    spdlog::info("{}:{}: {}", kind_, what_, message);
  else
    spdlog::warn("{}:{}: {}", kind_, what_, message);
}

// False when stopping.
bool WatchedSource::pause(std::chrono::milliseconds time) {
  std::unique_lock lock(mutex_);
  return !wake_.wait_for(lock, time, [&] { return stopping_; });
}

void WatchedSource::run() {
  for (;;) {
    auto session = connect();
    if (session == nullptr) return;
    watch(*session);
    bool had_frames = false;
    {
      const std::lock_guard lock(mutex_);
      had_frames = first_frame_;
    }
    retire(std::move(session));
    // A device that fails at its first frame is not opened as fast as it fails.
    if (!pause(had_frames ? 0ms : kRetry)) return;
  }
}

std::unique_ptr<CaptureSession> WatchedSource::connect() {
  for (;;) {
    forget_returned();
    auto session = make_session_();
    auto fault = session->find();
    if (!fault) {
      // What is there is let go before it is opened anew; while it is not there, nobody waits.
      wait_for_closing(kCloseWait);
      fault = session->open();
    }
    if (!fault) fault = session->start();
    if (fault) {
      close_in_background(std::move(session));
      report(fault->state, what_ + " " + fault->message);
      if (!pause(fault->retry)) return nullptr;
      continue;
    }
    if (begin(*session)) return session;
    close_in_background(std::move(session));
    return nullptr;
  }
}

ExposureChange WatchedSource::set_exposure_us(double exposure_us) {
  const std::lock_guard lock(mutex_);
  if (current_ == nullptr) return ExposureChange::not_now;
  if (!current_->sets_exposure()) return ExposureChange::never;
  wanted_exposure_us_ = exposure_us;
  current_->wake();
  return ExposureChange::asked;
}

// Kept for a camera that comes back: whoever changed it does not know that it went.
void WatchedSource::change_exposure(CaptureSession& session) {
  double wanted_us = 0;
  {
    const std::lock_guard lock(mutex_);
    if (wanted_exposure_us_ == set_exposure_us_) return;
    wanted_us = set_exposure_us_ = wanted_exposure_us_;
  }
  if (const Status set = session.set_exposure_us(wanted_us); !set) {
    spdlog::warn("{}:{}: exposure of {:g} us: {}", kind_, what_, wanted_us, set.error().message);
    return;
  }
  passing_over_ = kExposureDelayFrames;
  const std::lock_guard lock(mutex_);
  settings_ = session.settings();
}

// False when stopping.
bool WatchedSource::begin(CaptureSession& session) {
  const std::lock_guard lock(mutex_);
  if (stopping_) return false;
  current_ = &session;
  settings_ = session.settings();
  sequence_.reconnected();
  first_frame_ = false;
  set_exposure_us_ = 0;
  passing_over_ = 0;
  has_signal_ = true;
  last_frame_ = Clock::now();
  period_ = std::chrono::nanoseconds(
      settings_.rate_hz > 0 ? static_cast<std::int64_t>(1e9 / settings_.rate_hz) : 1'000'000'000);
  if (state_ == SourceState::no_device) state_ = SourceState::opening;
  return true;
}

// Until the session is over.
void WatchedSource::watch(CaptureSession& session) {
  auto looked = Clock::now();
  bool said = false;
  for (;;) {
    SessionFrame frame;
    change_exposure(session);
    const CaptureSession::Event event = session.next(kTick, frame);
    switch (event) {
      case CaptureSession::Event::frame:
        frame_done(session, frame);
        break;
      case CaptureSession::Event::nothing:
        break;
      case CaptureSession::Event::source_changed:
        return report(SourceState::wrong_format,
                      what_ + " sends another size or format now; opening it again");
      case CaptureSession::Event::broken: {
        const CaptureFault fault = session.fault();
        return report(fault.state, what_ + " " + fault.message);
      }
    }
    std::chrono::nanoseconds silence{0}, limit{0};
    bool has_frame = false, flowing = false, signal = true;
    {
      const std::lock_guard lock(mutex_);
      if (stopping_) return;
      silence = Clock::now() - last_frame_;
      limit = silence_limit();
      has_frame = first_frame_;
      flowing = has_frame && silence < limit;
      signal = has_signal_;
    }
    const SessionSettings& settings = session.settings();
    if (Clock::now() - looked > kLookAround) {
      looked = Clock::now();
      const std::string clock = settings.clock;
      look_around(session);
      said = said && clock == settings.clock;
      continue;
    }
    if (!signal) {
      said = false;
      continue;
    }
    if (flowing) silent_sessions_ = 0;
    if (!settings.free_running && !has_frame) {
      if (silence >= limit)
        report(SourceState::stalled, what_ + " has sent no frame yet: it is " +
                                         (settings.trigger.empty() ? "triggered" : settings.trigger));
      continue;
    }
    if (flowing || !settings.free_running) {
      if (!said) report(SourceState::streaming, summary(settings, stamp_));
      said = true;
      continue;
    }
    if (silence >= limit) {
      said = false;
      report(SourceState::stalled, what_ + " is there but sends no frames");
    }
    const auto reopen = std::max<std::chrono::nanoseconds>(10 * period_, kReopenMinimum) *
                        (1 << std::min(silent_sessions_, 2));
    if (silence < reopen) continue;
    ++silent_sessions_;
    return;
  }
}

// What no frame tells: signal and exposure.
void WatchedSource::look_around(CaptureSession& session) {
  forget_returned();
  const std::string missing = session.refresh();
  {
    const std::lock_guard lock(mutex_);
    settings_ = session.settings();
    has_signal_ = missing.empty();
    if (!has_signal_) last_frame_ = Clock::now();  // silence is not the camera's fault
  }
  if (!missing.empty()) report(SourceState::no_signal, what_ + " " + missing);
}

void WatchedSource::frame_done(CaptureSession& session, const SessionFrame& frame) noexcept {
  Slot old;
  {
    const std::lock_guard lock(mutex_);
    const auto now = Clock::now();
    // A slow camera moves its own limit; a single pause moves it by no more than a factor.
    if (first_frame_)
      period_ = std::max(period_ * 7 / 8, std::min<std::chrono::nanoseconds>(now - last_frame_, 4 * period_));
    last_frame_ = now;
    // What a driver sends without a signal is noise or a test picture.
    if (frame.outcome == SessionFrame::Outcome::incomplete || !has_signal_) {
      ++counters_.incomplete;
      counters_.lost += sequence_.incomplete(frame.frame_id);
      if (frame.outcome == SessionFrame::Outcome::complete) old = {&session, frame, {}};
    } else {
      const FrameSequence::Step step = sequence_.next(frame.frame_id);
      counters_.lost += step.lost;
      ++counters_.received;
      if (!first_frame_ && delivered_before_) ++counters_.reconnects;
      first_frame_ = delivered_before_ = true;
      stamp_ = frame.stamp;
      settings_.exposure_us = frame.exposure_us;
      settings_.rate_hz = session.settings().rate_hz;
      if (frame.outcome == SessionFrame::Outcome::passed_over) {
        ++counters_.skipped;
        return;
      }
      if (passing_over_ > 0) {
        --passing_over_;
        ++counters_.skipped;
        old = {&session, frame, {}};
      } else {
        old = std::exchange(slot_, {&session, frame, frame_info(frame, step.sequence)});
        if (old.session != nullptr) ++counters_.skipped;
        state_ = SourceState::streaming;
        frame_ready_.notify_one();
      }
    }
  }
  if (old.session != nullptr) old.session->give_back(old.frame.buffer);
}

FrameInfo WatchedSource::frame_info(const SessionFrame& frame, std::uint64_t sequence) noexcept {
  FrameInfo info;
  info.format = settings_.format;
  info.sequence = sequence;
  info.received_mono_ns = frame.received_mono_ns;
  const auto half_exposure = static_cast<std::int64_t>(frame.exposure_us * 500);
  std::int64_t middle = frame.received_mono_ns - half_exposure;
  if (frame.stamp == SessionFrame::Stamp::start_of_exposure) middle = frame.t_stamp_mono_ns + half_exposure;
  if (frame.stamp == SessionFrame::Stamp::end_of_frame || frame.stamp == SessionFrame::Stamp::mapped)
    middle = frame.t_stamp_mono_ns - half_exposure;
  info.capture_mono_ns = std::max(std::min(middle, frame.received_mono_ns), last_capture_ns_ + 1);
  last_capture_ns_ = info.capture_mono_ns;
  info.capture_utc_ns = info.capture_mono_ns + (utc_now_ns() - mono_now_ns());
  info.exposure_us = frame.exposure_us;
  info.gain_db = frame.gain_db;
  info.temperature_c = frame.temperature_c;
  return info;
}

void WatchedSource::retire(std::unique_ptr<CaptureSession> session) {
  Slot left;
  {
    const std::lock_guard lock(mutex_);
    current_ = nullptr;
    left = std::exchange(slot_, {});
    if (left.session != nullptr) ++counters_.skipped;
  }
  if (left.session != nullptr) left.session->give_back(left.frame.buffer);
  close_in_background(std::move(session));
}

void WatchedSource::close_in_background(std::unique_ptr<CaptureSession> session) {
  CaptureSession* at = session.get();
  retired_.push_back({std::move(session), std::async(std::launch::async, [at] { at->close(); })});
}

// All together until then.
void WatchedSource::wait_for_closing(std::chrono::milliseconds limit) {
  const auto until = Clock::now() + limit;
  for (const Retired& retired : retired_) retired.closed.wait_until(until);
}

void WatchedSource::forget_returned() {
  std::erase_if(retired_, [](const Retired& retired) {
    return retired.closed.wait_for(0s) == std::future_status::ready && retired.session->all_returned();
  });
}

std::chrono::nanoseconds WatchedSource::silence_limit() const {
  const auto limit = std::max<std::chrono::nanoseconds>(3 * period_, kSilenceMinimum);
  return first_frame_ ? limit : std::max<std::chrono::nanoseconds>(limit, kFirstFrameLimit);
}

SourceState WatchedSource::state() const noexcept {
  const std::lock_guard lock(mutex_);
  const bool silent = current_ != nullptr && has_signal_ && settings_.free_running &&
                      Clock::now() - last_frame_ > silence_limit();
  return state_ == SourceState::streaming && silent ? SourceState::stalled : state_;
}

std::string WatchedSource::describe() const {
  const std::lock_guard lock(mutex_);
  return message_;
}

CaptureCounters WatchedSource::counters() const noexcept {
  const std::lock_guard lock(mutex_);
  return counters_;
}

double WatchedSource::rate_hz() const noexcept {
  const std::lock_guard lock(mutex_);
  return settings_.rate_hz;
}

}  // namespace lightwell
