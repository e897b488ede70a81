// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <semaphore>
#include <span>
#include <string>
#include <thread>

#include "daemon/record/frame_ring.h"
#include "daemon/record/recorder.h"

namespace lightwell {

// One take from beginning to end: the ring that the frame path fills and the thread that writes.
class Recorder::Session {
 public:
  Session(std::string file, const FrameFormat& format, std::size_t ring_frames,
          std::unique_ptr<RecordingWriter> writer);
  ~Session();

  void offer(const FrameInfo& info, std::span<const std::byte> codes) noexcept;
  // Writes what waits and closes; how the take ended. Once; failed from then on.
  Status finish();

  [[nodiscard]] bool active() const noexcept { return !finished_.load(std::memory_order_acquire); }
  [[nodiscard]] const std::string& file() const noexcept { return file_; }
  [[nodiscard]] Stats stats() const;

 private:
  void run();
  Status drain();
  Status end(Status status);
  void count();

  const std::string file_;
  const FrameFormat format_;
  FrameRing ring_;
  const std::unique_ptr<RecordingWriter> writer_;
  std::counting_semaphore<> wake_{0};
  std::atomic<bool> accepting_{true}, stopping_{false}, format_changed_{false}, finished_{false};
  std::atomic<std::uint64_t> frames_{0}, dropped_{0}, bytes_{0};
  mutable std::mutex mutex_;
  Status outcome_;
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace lightwell
