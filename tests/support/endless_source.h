// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "daemon/capture/capture_source.h"
#include "daemon/clock.h"

namespace lightwell::test {

// A camera in this process that always has the next frame: the pictures in turn, so many frames of them, as fast as
// they are taken. Allocates nothing after start.
class EndlessSource final : public CaptureSource {
 public:
  // before: called on the frame path's thread before each frame, with how many have been taken
  EndlessSource(const FrameFormat& format, double rate_hz, std::vector<std::vector<std::byte>> pictures,
                std::uint64_t frames, std::function<void(std::uint64_t)> before)
      : format_(format),
        rate_hz_(rate_hz),
        pictures_(std::move(pictures)),
        frames_(frames),
        before_(std::move(before)) {}

  Status start() override { return {}; }
  FrameLease wait(std::chrono::milliseconds timeout) noexcept override {
    const std::uint64_t taken = taken_.load();
    if (!ended_) before_(taken);
    if (taken == frames_) {
      ended_ = true;
      std::this_thread::sleep_for(timeout);
      return {};
    }
    FrameInfo info;
    info.format = format_;
    info.sequence = taken;
    info.received_mono_ns = mono_now_ns();
    // The camera's own time runs at its rate, however fast it is emptied: a gap would reset the filter.
    if (taken == 0) start_ns_ = info.received_mono_ns;
    info.capture_mono_ns = start_ns_ + static_cast<std::int64_t>(static_cast<double>(taken) * 1e9 / rate_hz_);
    info.exposure_us = 10000;
    taken_.store(taken + 1);
    return {info, pictures_[taken % pictures_.size()], [](void*, void*) noexcept {}, this, nullptr};
  }
  void stop() noexcept override {}
  [[nodiscard]] SourceState state() const noexcept override {
    return ended_ ? SourceState::ended : SourceState::streaming;
  }
  [[nodiscard]] std::string describe() const override { return "frames without end"; }
  [[nodiscard]] CaptureCounters counters() const noexcept override { return {.received = taken_.load()}; }
  [[nodiscard]] double rate_hz() const noexcept override { return rate_hz_; }

 private:
  FrameFormat format_;
  double rate_hz_;
  std::vector<std::vector<std::byte>> pictures_;
  std::uint64_t frames_;
  std::function<void(std::uint64_t)> before_;
  std::atomic<std::uint64_t> taken_{0};
  std::atomic<bool> ended_{false};
  std::int64_t start_ns_ = 0;
};

}  // namespace lightwell::test
