// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "interface/recording.h"

namespace lightwell {

// Frames on their way from one thread to one other, in memory allocated once. Neither side waits for the
// other.
class FrameRing {
 public:
  FrameRing(std::size_t frame_bytes, std::size_t frames)
      : frame_bytes_(frame_bytes), frames_(frames), codes_(frame_bytes * frames) {}

  // Writer. False: full, or codes of another size.
  bool push(const RecordedFrame& frame, std::span<const std::byte> codes) noexcept {
    const std::uint64_t written = written_.load(std::memory_order_relaxed);
    if (written - read_.load(std::memory_order_acquire) == frames_.size() || codes.size() != frame_bytes_)
      return false;
    const std::size_t i = written % frames_.size();
    frames_[i] = frame;
    std::copy(codes.begin(), codes.end(), codes_.begin() + static_cast<std::ptrdiff_t>(i * frame_bytes_));
    written_.store(written + 1, std::memory_order_release);
    return true;
  }

  struct Entry {
    const RecordedFrame& frame;
    std::span<const std::byte> codes;
  };
  // Reader: the oldest frame, until pop. Only where there is one.
  [[nodiscard]] bool empty() const noexcept {
    return written_.load(std::memory_order_acquire) == read_.load(std::memory_order_relaxed);
  }
  [[nodiscard]] Entry front() const noexcept {
    const std::size_t i = read_.load(std::memory_order_relaxed) % frames_.size();
    return {frames_[i], std::span(codes_).subspan(i * frame_bytes_, frame_bytes_)};
  }
  void pop() noexcept { read_.fetch_add(1, std::memory_order_release); }

 private:
  const std::size_t frame_bytes_;
  std::vector<RecordedFrame> frames_;
  std::vector<std::byte> codes_;
  std::atomic<std::uint64_t> written_{0}, read_{0};
};

}  // namespace lightwell
