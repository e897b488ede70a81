// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "daemon/capture/capture_session.h"
#include "daemon/capture/capture_source.h"
#include "daemon/capture/frame_sequence.h"

namespace lightwell {

// A device that is opened, watched and opened again, through one CaptureSession after another. One thread does all work
// with it: opens it, takes its frames, watches signal and silence; it puts the freshest frame into one slot, and wait
// takes it from there. Sessions are closed on threads of their own: one that has failed may take seconds.
// Times: the device's, where it stamps in CLOCK_MONOTONIC or its clock is mapped to it: the start of the exposure, or
// else the end of the frame, which counts as the end of the exposure since read-out is not known; of reception where it
// stamps otherwise.
class WatchedSource final : public CaptureSource {
 public:
  using Connect = std::function<std::unique_ptr<CaptureSession>()>;

  // kind: "v4l2"; what: "/dev/video0"; refusal: why start fails, where trying cannot help
  WatchedSource(std::string kind, std::string what, Connect connect, Status refusal = {});
  ~WatchedSource() override;  // waits for what stop did not: up to 8 s where a camera is dead

  Status start() override;
  FrameLease wait(std::chrono::milliseconds timeout) noexcept override;
  ExposureChange set_exposure_us(double exposure_us) override;
  void stop() noexcept override;
  [[nodiscard]] SourceState state() const noexcept override;
  [[nodiscard]] std::string describe() const override;
  [[nodiscard]] CaptureCounters counters() const noexcept override;
  [[nodiscard]] double rate_hz() const noexcept override;

 private:
  using Clock = std::chrono::steady_clock;
  struct Slot {
    CaptureSession* session = nullptr;
    SessionFrame frame;
    FrameInfo info;
  };
  struct Retired {
    std::unique_ptr<CaptureSession> session;
    std::future<void> closed;
  };

  void run();
  std::unique_ptr<CaptureSession> connect();
  bool begin(CaptureSession& session);
  void watch(CaptureSession& session);
  void look_around(CaptureSession& session);
  void change_exposure(CaptureSession& session);
  void frame_done(CaptureSession& session, const SessionFrame& frame) noexcept;
  FrameInfo frame_info(const SessionFrame& frame, std::uint64_t sequence) noexcept;
  void retire(std::unique_ptr<CaptureSession> session);
  void close_in_background(std::unique_ptr<CaptureSession> session);
  void wait_for_closing(std::chrono::milliseconds limit);
  void forget_returned();
  void report(SourceState state, const std::string& message);
  bool pause(std::chrono::milliseconds time);
  [[nodiscard]] std::chrono::nanoseconds silence_limit() const;

  const std::string kind_, what_;
  const Connect make_session_;
  const Status refusal_;
  std::thread thread_;
  std::vector<Retired> retired_;  // of the thread: sessions that are closing, or whose frames are out
  std::int64_t last_capture_ns_ = 0;
  FrameSequence sequence_;
  int passing_over_ = 0;     // frames whose exposure is not known since it was changed
  int silent_sessions_ = 0;  // one after another

  mutable std::mutex mutex_;  // guards everything below; held for moments only, never while a device is asked
  std::condition_variable frame_ready_, wake_;
  bool stopping_ = false;
  CaptureSession* current_ = nullptr;
  Slot slot_;
  SessionSettings settings_;
  SessionFrame::Stamp stamp_ = SessionFrame::Stamp::none;
  Clock::time_point last_frame_;        // or the start of the session
  std::chrono::nanoseconds period_{0};  // nominal, or as measured where that is longer
  bool first_frame_ = false;            // of this session, has come
  bool has_signal_ = false;
  double wanted_exposure_us_ = 0,
         set_exposure_us_ = 0;  // since the start, of this session; 0: as it was opened
  CaptureCounters counters_;
  bool delivered_before_ = false;
  SourceState state_ = SourceState::no_device;
  std::string message_;
};

}  // namespace lightwell
