// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/record/recording_session.h"

#include <chrono>
#include <utility>

namespace lightwell {

Recorder::Session::Session(std::string file, const FrameFormat& format, std::size_t ring_frames,
                           std::unique_ptr<RecordingWriter> writer)
    : file_(std::move(file)),
      format_(format),
      ring_(format.bytes(), ring_frames),
      writer_(std::move(writer)),
      thread_([this] { run(); }) {}

Recorder::Session::~Session() {
  static_cast<void>(finish());
}

void Recorder::Session::offer(const FrameInfo& info, std::span<const std::byte> codes) noexcept {
  if (!accepting_.load(std::memory_order_acquire)) return;
  if (info.format != format_) {
    accepting_.store(false, std::memory_order_release);
    format_changed_.store(true, std::memory_order_release);
  } else if (!ring_.push(recorded_frame(info), codes)) {
    dropped_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  wake_.release();
}

Status Recorder::Session::finish() {
  if (!thread_.joinable()) return Error{ErrorKind::failed, "recording: none is being written"};
  accepting_.store(false, std::memory_order_release);
  stopping_.store(true, std::memory_order_release);
  wake_.release();
  thread_.join();
  const std::lock_guard lock(mutex_);
  return outcome_;
}

void Recorder::Session::run() {
  constexpr std::chrono::milliseconds kIdle{400};  // where frames pause, the last ones still reach the disk
  Status status;
  for (bool last = false; status && !last;) {
    const bool woken = wake_.try_acquire_for(kIdle);
    last = stopping_.load(std::memory_order_acquire) || format_changed_.load(std::memory_order_acquire);
    status = drain();
    if (status && !woken) status = writer_->flush();
  }
  accepting_.store(false, std::memory_order_release);
  status = end(std::move(status));
  {
    const std::lock_guard lock(mutex_);
    outcome_ = std::move(status);
  }
  finished_.store(true, std::memory_order_release);
}

Status Recorder::Session::drain() {
  for (; !ring_.empty(); ring_.pop()) {
    const FrameRing::Entry entry = ring_.front();
    if (Status status = writer_->write(entry.frame, entry.codes); !status) return status;
    count();
  }
  return {};
}

Status Recorder::Session::end(Status status) {
  Status closed = writer_->close();
  count();
  if (!status) return status;
  if (!closed || !format_changed_.load(std::memory_order_acquire)) return closed;
  return Error{ErrorKind::failed, "recording: " + file_ +
                                      " has ended, because the camera's frames are no longer " +
                                      std::to_string(format_.width) + "x" + std::to_string(format_.height) +
                                      " " + std::string(name(format_.pixel_format))};
}

void Recorder::Session::count() {
  frames_.store(writer_->frames(), std::memory_order_relaxed);
  bytes_.store(writer_->bytes(), std::memory_order_relaxed);
}

Recorder::Stats Recorder::Session::stats() const {
  Stats stats;
  stats.active = active();
  stats.file = file_;
  stats.frames = frames_.load(std::memory_order_relaxed);
  stats.dropped = dropped_.load(std::memory_order_relaxed);
  stats.bytes = bytes_.load(std::memory_order_relaxed);
  const std::lock_guard lock(mutex_);
  if (!outcome_) stats.error = outcome_.error().message;
  return stats;
}

}  // namespace lightwell
