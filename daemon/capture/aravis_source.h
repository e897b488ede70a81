// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "daemon/capture/aravis_session.h"
#include "daemon/capture/capture_source.h"
#include "daemon/capture/device_clock.h"
#include "daemon/capture/frame_sequence.h"

namespace lightwell {

// A GigE Vision camera at an IPv4 address. A control thread does all work with the device: finds it, opens
// it, watches for stalls, opens it again; the stream's thread puts the freshest frame into one slot; wait
// takes it from there. A connection that has failed is torn down on a thread of its own, since a dead camera
// takes seconds to let go.
class AravisSource final : public CaptureSource, private AravisSession::Listener {
 public:
  // address: checked by start
  AravisSource(std::string address, const CaptureOptions& options);
  ~AravisSource() override;  // waits for what stop did not: up to 8 s where the camera is dead

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
    AravisSession* session = nullptr;
    ReceivedFrame frame;
    FrameInfo info;
  };
  struct Retired {
    std::unique_ptr<AravisSession> session;
    std::thread closing;
    bool closed = false;
  };
  enum class Outcome { stopped, lost, silent, wrong_format };

  void frame_done(AravisSession& session, const ReceivedFrame& frame) noexcept override;
  void control_lost(AravisSession& session) noexcept override;

  void run();
  std::unique_ptr<AravisSession> connect();
  Result<std::unique_ptr<AravisSession>> try_connect();
  Outcome watch();
  void retire(Outcome why);
  void close_in_background(std::unique_ptr<AravisSession> session, bool stop_camera);
  void forget_returned(bool wait);
  void report(SourceState state, const std::string& message);
  FrameInfo frame_info(const ReceivedFrame& frame, std::uint64_t sequence);
  bool pause(std::chrono::milliseconds time);
  std::chrono::nanoseconds silence_limit() const;

  const std::string address_;
  const CaptureOptions options_;
  std::thread control_;

  mutable std::mutex mutex_;  // guards everything below; held for moments only, never while a device is asked
  std::condition_variable frame_ready_, control_wake_, closed_;
  bool stopping_ = false;
  AravisSession* current_ = nullptr;  // frames of any other session are late and go back
  std::unique_ptr<AravisSession> session_;
  std::vector<std::unique_ptr<Retired>> retired_;
  Slot slot_;
  CameraSettings settings_;
  bool lost_ = false, wrong_format_ = false;
  Clock::time_point last_frame_;        // or the start of the session
  std::chrono::nanoseconds period_{0};  // nominal, or as measured where that is longer
  bool first_frame_ = false;            // of this session, has come
  int silent_sessions_ = 0;             // one after another
  std::int64_t last_capture_ns_ = 0;
  FrameSequence sequence_;
  DeviceClock device_clock_;
  CaptureCounters counters_;
  bool delivered_before_ = false;
  SourceState state_ = SourceState::no_device;
  std::string message_;
};

}  // namespace lightwell
