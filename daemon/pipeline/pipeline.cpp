// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/pipeline.h"

#include <pthread.h>
#include <sched.h>

#include <cmath>
#include <utility>

#include "daemon/clock.h"

namespace lightwell {
namespace {

// Ahead of renderers and encoders on a small machine, where the system lets us; without the right it is not
// an error.
void ask_for_real_time() noexcept {
  sched_param parameter{};
  parameter.sched_priority = 10;
  pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameter);
  pthread_setname_np(pthread_self(), "frame-path");
}

// Radiance is what was seen in how long: without an exposure there is none.
Status check_exposure(const FrameInfo& info) {
  if (info.exposure_us > 0 && std::isfinite(info.exposure_us)) return {};
  return Error{ErrorKind::bad_input, "frame exposure_us = " + std::to_string(info.exposure_us) +
                                         ": allowed a finite number above 0; the source does not say how "
                                         "long it exposes"};
}

}  // namespace

Pipeline::Pipeline(FrameSink* sink, std::vector<FrameStamper*> stampers)
    : sink_(sink), stampers_(std::move(stampers)) {}

Pipeline::~Pipeline() {
  stop();
}

Status Pipeline::start(std::shared_ptr<CaptureSource> source, std::shared_ptr<FramePath> path) {
  verify_bug(!thread_.joinable(), "pipeline started twice");
  Status started = source->start();
  if (!started) return started;
  {
    const std::scoped_lock lock(mutex_);  // whoever asks for a view may do so already
    source_ = std::move(source);
    path_ = std::move(path);
  }
  stopping_ = false;
  thread_ = std::thread([this] { run(); });
  return {};
}

Status Pipeline::replace(std::shared_ptr<CaptureSource> source, std::shared_ptr<FramePath> path) {
  if (source) {
    Status started = source->start();
    if (!started) return started;
  }
  if (!source) make_tables(*path);
  {
    const std::scoped_lock lock(mutex_);
    // A replacement that still waits gives way, but for its source where this one keeps the source.
    if (source) next_source_.swap(source);
    next_path_ = std::move(path);
    replacement_waits_ = true;
  }
  if (source) retired_.take(std::move(source));  // the one that gave way
  return {};
}

// For the frames that come now. What cannot be made is said by the frame path, when it meets a frame.
void Pipeline::make_tables(FramePath& path) const {
  std::optional<FrameFormat> format;
  double rate_hz = 0;
  {
    const std::scoped_lock lock(mutex_);
    if (next_source_ || !source_) return;  // another camera is to come, its frames are not known
    format = format_;
    rate_hz = source_->rate_hz();
  }
  if (format) static_cast<void>(path.prepare(*format, rate_hz));
}

void Pipeline::stop() noexcept {
  stopping_ = true;
  if (thread_.joinable()) thread_.join();
  std::shared_ptr<CaptureSource> never_taken;
  {
    const std::scoped_lock lock(mutex_);
    never_taken.swap(next_source_);
    next_path_.reset();
    replacement_waits_ = false;
  }
  if (never_taken) retired_.take(std::move(never_taken));
  retired_.settle();
}

Pipeline::View Pipeline::view() const {
  const std::scoped_lock lock(mutex_);
  return {source_, path_, mismatch_, measured_rate_hz_.load(std::memory_order_relaxed),
          dropped_.load(std::memory_order_relaxed)};
}

void Pipeline::run() noexcept {
  ask_for_real_time();
  while (!stopping_) {
    heartbeat_.fetch_add(1, std::memory_order_relaxed);
    if (replacement_waits_.load(std::memory_order_acquire)) take_replacement();
    const FrameLease frame = source_->wait(std::chrono::milliseconds(100));
    if (frame) handle(frame);
    measure_rate(mono_now_ns());
  }
  source_->stop();
}

// The only place that changes source_ and path_ once the thread runs, so the loop reads them without the
// lock.
void Pipeline::take_replacement() {
  std::shared_ptr<CaptureSource> old_source;
  std::shared_ptr<FramePath> old_path;
  {
    const std::scoped_lock lock(mutex_);
    next_path_->continue_from(path_->published());
    old_path = std::exchange(path_, std::move(next_path_));
    if (next_source_) {
      old_source = std::exchange(source_, std::move(next_source_));
      format_.reset();
      handled_format_.reset();
    }
    mismatch_.clear();
    replacement_waits_ = false;
  }
  mismatched_ = false;
  retired_.take(std::move(old_source), std::move(old_path));
}

void Pipeline::handle(const FrameLease& frame) {
  if (handled_format_ != frame.info().format) {
    handled_format_ = frame.info().format;
    const std::scoped_lock lock(mutex_);
    format_ = handled_format_;
  }
  Status ready = check_exposure(frame.info());
  if (ready) ready = path_->prepare(frame.info().format, source_->rate_hz());
  if (!ready || mismatched_) {  // rare: state changes only
    const std::scoped_lock lock(mutex_);
    mismatch_ = ready ? "" : ready.error().message;
    mismatched_ = !ready.ok();
  }
  if (!ready) {
    dropped_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  FrameInfo info = frame.info();
  for (FrameStamper* stamper : stampers_) stamper->stamp(info);
  path_->process(info, frame.bytes());
  if (sink_ != nullptr) sink_->offer(info, frame.bytes());
}

// Published frames over windows of two seconds.
void Pipeline::measure_rate(std::int64_t now_ns) noexcept {
  const std::uint64_t published = path_->published();
  if (rate_window_start_ns_ == 0) rate_window_start_ns_ = now_ns;
  const double seconds = static_cast<double>(now_ns - rate_window_start_ns_) * 1e-9;
  if (seconds < 2) return;
  measured_rate_hz_ = static_cast<double>(published - rate_window_published_) / seconds;
  rate_window_start_ns_ = now_ns;
  rate_window_published_ = published;
}

}  // namespace lightwell
