// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "daemon/capture/capture_source.h"
#include "daemon/capture/frame_sequence.h"
#include "daemon/capture/v4l2_session.h"

namespace lightwell {

// A V4L2 capture device at a path such as /dev/video0, or a link below /dev/v4l/by-id that follows a camera from
// socket to socket. One thread does all work with the device: opens it, takes its frames, watches signal and
// silence, opens it again; it puts the freshest frame into one slot, and wait takes it from there.
// Times: the driver's, where it stamps in CLOCK_MONOTONIC: the start of the exposure, or else the end of the frame,
// which counts as the end of the exposure since read-out is not known; of reception where it stamps otherwise.
class V4l2Source final : public CaptureSource {
 public:
  V4l2Source(std::string path, const CaptureOptions& options, V4l2Calls& calls = system_v4l2_calls());
  ~V4l2Source() override;

  Status start() override;
  FrameLease wait(std::chrono::milliseconds timeout) noexcept override;
  void stop() noexcept override;
  [[nodiscard]] SourceState state() const noexcept override;
  [[nodiscard]] std::string describe() const override;
  [[nodiscard]] CaptureCounters counters() const noexcept override;
  [[nodiscard]] double rate_hz() const noexcept override;

 private:
  using Clock = std::chrono::steady_clock;
  struct Slot {
    V4l2Session* session = nullptr;
    V4l2Frame frame;
    FrameInfo info;
  };

  void run();
  std::unique_ptr<V4l2Session> connect();
  void watch(V4l2Session& session);
  void look_around(V4l2Session& session);
  void frame_done(V4l2Session& session, const V4l2Frame& frame) noexcept;
  FrameInfo frame_info(const V4l2Frame& frame, std::uint64_t sequence) noexcept;
  void retire(std::unique_ptr<V4l2Session> session);
  void forget_returned();
  void report(SourceState state, const std::string& message);
  bool pause(std::chrono::milliseconds time);
  [[nodiscard]] std::chrono::nanoseconds silence_limit() const;

  const std::string path_;
  const CaptureOptions options_;
  V4l2Calls& calls_;
  std::thread thread_;
  std::vector<std::unique_ptr<V4l2Session>> retired_;  // of the thread: sessions whose frames are out
  std::int64_t last_capture_ns_ = 0;
  FrameSequence sequence_;
  int silent_sessions_ = 0;  // one after another

  mutable std::mutex mutex_;  // guards everything below; held for moments only, never while a device is asked
  std::condition_variable frame_ready_, wake_;
  bool stopping_ = false;
  V4l2Session* current_ = nullptr;
  Slot slot_;
  V4l2Settings settings_;
  V4l2Frame::Stamp stamp_ = V4l2Frame::Stamp::none;
  Clock::time_point last_frame_;        // or the start of the session
  std::chrono::nanoseconds period_{0};  // nominal, or as measured where that is longer
  bool first_frame_ = false;            // of this session, has come
  bool has_signal_ = false;
  CaptureCounters counters_;
  bool delivered_before_ = false;
  SourceState state_ = SourceState::no_device;
  std::string message_;
};

}  // namespace lightwell
