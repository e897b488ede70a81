// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/recording_source.h"

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "daemon/capture/buffer_pool.h"
#include "daemon/capture/recorded_times.h"
#include "interface/recording.h"

namespace lightwell {
namespace {

using Clock = std::chrono::steady_clock;  // CLOCK_MONOTONIC

class RecordingSource final : public CaptureSource {
 public:
  RecordingSource(std::string file, std::unique_ptr<RecordingReader> reader, std::unique_ptr<BufferPool> pool,
                  const CaptureOptions& options);
  ~RecordingSource() override { stop(); }

  Status start() override;
  FrameLease wait(std::chrono::milliseconds timeout) noexcept override;
  void stop() noexcept override;
  [[nodiscard]] SourceState state() const noexcept override;
  [[nodiscard]] std::string describe() const override;
  [[nodiscard]] CaptureCounters counters() const noexcept override;
  [[nodiscard]] double rate_hz() const noexcept override {
    return options_.speed > 0 ? header_.rate_hz * options_.speed : header_.rate_hz;
  }

 private:
  struct Decoded {
    FrameInfo info;
    Clock::time_point due;
    std::size_t buffer = 0;
    std::uint64_t lost_before = 0;
  };
  enum class Next { frame, none, end };

  static void give_back(void* self, void* token) noexcept;
  [[nodiscard]] bool lossless() const { return options_.speed == 0; }

  // The decoding thread.
  void run();
  bool take_buffer(std::size_t& buffer);
  Next decode(std::size_t buffer, Decoded& decoded);
  void note_damage(const std::string& what);
  void push(const Decoded& decoded);

  // Under the mutex.
  Decoded& ready(std::size_t i) { return ready_[(first_ready_ + i) % ready_.size()]; }
  Decoded pop();
  void skip_oldest();

  const std::string file_;
  const CaptureOptions options_;
  const std::unique_ptr<RecordingReader> reader_;  // the decoding thread's
  const RecordingHeader header_;
  const std::unique_ptr<BufferPool> pool_;
  RecordedTimes times_;  // the decoding thread's
  std::thread thread_;

  mutable std::mutex mutex_;
  std::condition_variable decoded_;  // a frame is ready, or the end is near: for wait
  std::condition_variable freed_;    // a buffer came back, or it is over: for the decoding thread
  std::vector<std::size_t> free_;
  std::vector<Decoded> ready_;  // a ring
  std::size_t first_ready_ = 0, ready_count_ = 0;
  CaptureCounters counters_;
  std::string damage_;
  bool started_ = false, streaming_ = false, finished_ = false, stopping_ = false;
};

RecordingSource::RecordingSource(std::string file, std::unique_ptr<RecordingReader> reader,
                                 std::unique_ptr<BufferPool> pool, const CaptureOptions& options)
    : file_(std::move(file)),
      options_(options),
      reader_(std::move(reader)),
      header_(reader_->header()),
      pool_(std::move(pool)),
      times_(options.speed, header_.rate_hz),
      ready_(pool_->count()) {
  free_.reserve(pool_->count());
  for (std::size_t i = pool_->count(); i-- > 0;) free_.push_back(i);
}

Status RecordingSource::start() {
  const std::lock_guard lock(mutex_);
  if (thread_.joinable()) return {};
  if (started_) {  // again, after a stop: from the beginning
    if (Status status = reader_->rewind(); !status) return status;
    times_ = RecordedTimes(options_.speed, header_.rate_hz);
  }
  started_ = true;
  stopping_ = streaming_ = finished_ = false;
  thread_ = std::thread([this] { run(); });
  return {};
}

void RecordingSource::stop() noexcept {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  freed_.notify_all();
  decoded_.notify_all();
  if (thread_.joinable()) thread_.join();
  const std::lock_guard lock(mutex_);
  streaming_ = false;
  for (; ready_count_ > 0; --ready_count_) {
    free_.push_back(ready(0).buffer);
    first_ready_ = (first_ready_ + 1) % ready_.size();
  }
}

void RecordingSource::give_back(void* self, void* token) noexcept {
  auto& source = *static_cast<RecordingSource*>(self);
  {
    const std::lock_guard lock(source.mutex_);
    source.free_.push_back(reinterpret_cast<std::size_t>(token));  // within its reserve
  }
  source.freed_.notify_one();
}

RecordingSource::Decoded RecordingSource::pop() {
  const Decoded oldest = ready(0);
  first_ready_ = (first_ready_ + 1) % ready_.size();
  --ready_count_;
  ++counters_.received;
  counters_.lost += oldest.lost_before;
  return oldest;
}

void RecordingSource::skip_oldest() {
  free_.push_back(pop().buffer);
  ++counters_.skipped;
}

FrameLease RecordingSource::wait(std::chrono::milliseconds timeout) noexcept {
  const auto deadline = Clock::now() + timeout;
  std::unique_lock lock(mutex_);
  for (;;) {
    const auto now = Clock::now();
    if (stopping_) return {};
    if (ready_count_ > 0 && (lossless() || ready(0).due <= now)) {
      while (!lossless() && ready_count_ > 1 && ready(1).due <= now) skip_oldest();
      const Decoded taken = pop();
      streaming_ = true;
      freed_.notify_one();
      // NOLINTNEXTLINE(performance-no-int-to-ptr): the lease's token is the buffer's number, not an address
      void* const token = reinterpret_cast<void*>(taken.buffer);
      return {taken.info, pool_->buffer(taken.buffer), &RecordingSource::give_back, this, token};
    }
    if (now >= deadline) return {};
    decoded_.wait_until(lock, ready_count_ > 0 ? std::min(deadline, ready(0).due) : deadline);
  }
}

// A buffer to decode into; where all are full, that of a frame which a fresher one has overtaken. False:
// stop.
bool RecordingSource::take_buffer(std::size_t& buffer) {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (stopping_) return false;
    if (free_.empty() && !lossless() && ready_count_ > 1 && ready(1).due <= Clock::now()) skip_oldest();
    if (!free_.empty()) {
      buffer = free_.back();
      free_.pop_back();
      return true;
    }
    if (!lossless() && ready_count_ > 1)
      freed_.wait_until(lock, Clock::time_point(ready(1).due));
    else
      freed_.wait(lock);
  }
}

void RecordingSource::note_damage(const std::string& what) {
  const std::lock_guard lock(mutex_);
  if (damage_.empty()) damage_ = what;
  ++counters_.incomplete;
}

RecordingSource::Next RecordingSource::decode(std::size_t buffer, Decoded& decoded) {
  const auto read = reader_->read(pool_->buffer(buffer));
  if (!read) {
    note_damage(read.error().message);
    return Next::none;
  }
  if (!*read) return Next::end;
  decoded.lost_before = times_.lost_before(**read);
  const RecordedTimes::Played played = times_.play(**read);
  decoded.buffer = buffer;
  decoded.due = Clock::time_point(std::chrono::nanoseconds(played.due_mono_ns));
  decoded.info = {.format = header_.format,
                  .sequence = played.frame.sequence,
                  .capture_mono_ns = played.frame.capture_mono_ns,
                  .received_mono_ns = played.frame.received_mono_ns,
                  .capture_utc_ns = played.frame.capture_utc_ns,
                  .exposure_us = played.frame.exposure_us,
                  .gain_db = played.frame.gain_db,
                  .temperature_c = played.frame.temperature_c,
                  .timecode = played.frame.timecode,
                  .complete = true};
  return Next::frame;
}

void RecordingSource::push(const Decoded& decoded) {
  {
    const std::lock_guard lock(mutex_);
    ready_[(first_ready_ + ready_count_) % ready_.size()] = decoded;
    ++ready_count_;
  }
  decoded_.notify_one();
}

void RecordingSource::run() {
  bool any = false;  // in this pass: a take without a whole frame must not be looped
  for (std::size_t buffer = 0; take_buffer(buffer);) {
    Decoded decoded;
    const Next next = decode(buffer, decoded);
    if (next == Next::frame) {
      any = true;
      push(decoded);
      continue;
    }
    {
      const std::lock_guard lock(mutex_);
      free_.push_back(buffer);
    }
    if (next == Next::none) continue;
    if (options_.loop && any) {
      if (const Status status = reader_->rewind(); status) {
        times_.begin_again();
        any = false;
        continue;
      } else {
        note_damage(status.error().message);
      }
    }
    const std::lock_guard lock(mutex_);
    finished_ = true;
    return;
  }
}

SourceState RecordingSource::state() const noexcept {
  const std::lock_guard lock(mutex_);
  if (finished_ && ready_count_ == 0) return SourceState::ended;
  return streaming_ ? SourceState::streaming : SourceState::opening;
}

std::string RecordingSource::describe() const {
  const FrameFormat& format = header_.format;
  std::string text = file_ + ": " + std::to_string(format.width) + "x" + std::to_string(format.height) + " " +
                     std::string(name(format.pixel_format));
  const auto number = [](double value) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.4g", value);
    return std::string(digits);
  };
  if (header_.rate_hz > 0) text += " at " + number(header_.rate_hz) + " Hz";
  text += state() == SourceState::ended ? ", ended"
          : lossless()                  ? ", every frame as fast as it is taken"
                                        : ", played at speed " + number(options_.speed);
  const std::lock_guard lock(mutex_);
  if (!damage_.empty()) text += "; " + damage_;
  return text;
}

CaptureCounters RecordingSource::counters() const noexcept {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace

Result<std::unique_ptr<CaptureSource>> make_recording_source(const std::string& file,
                                                             const CaptureOptions& options) {
  constexpr int kMinBuffers = 3;  // one being decoded, one ready, one leased
  if (!(options.speed >= 0) || !std::isfinite(options.speed))
    return Error{ErrorKind::usage, "capture speed " + std::to_string(options.speed) + " is not 0 or above"};
  if (options.buffers < kMinBuffers)
    return Error{ErrorKind::usage, "capture buffers " + std::to_string(options.buffers) + " is not " +
                                       std::to_string(kMinBuffers) + " or above"};
  auto reader = RecordingReader::open(file);
  if (!reader) return reader.error();
  auto pool =
      BufferPool::create((*reader)->header().format.bytes(), static_cast<std::size_t>(options.buffers));
  if (!pool)
    return Error{ErrorKind::failed,
                 file + ": not enough memory for " + std::to_string(options.buffers) + " frames"};
  return std::unique_ptr<CaptureSource>(
      std::make_unique<RecordingSource>(file, std::move(*reader), std::move(pool), options));
}

}  // namespace lightwell
