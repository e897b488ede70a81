// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "daemon/pipeline/pipeline.h"
#include "daemon/sync/strobe_ring.h"

namespace lightwell {

// Gives frames the exposure that the sync board measured for them. A frame belongs to the last exposure that had ended when
// it was whole in memory, so that read-out and transfer together must take less than a frame's period. That is looked up some
// frames later, when the strobes of that time have surely come; where trigger less sequence is the same for several frames
// in a row it binds the frames that come. A frame whose own strobe is not there is left as its camera stamped it.
class ExposureStamper final : public FrameStamper {
 public:
  explicit ExposureStamper(const StrobeRing& strobes) : strobes_(strobes) {}

  // Sets capture_mono_ns and capture_utc_ns where the exposure is known; false where not. How long the exposure was stays
  // the camera's word, by which it was calibrated. Frame path only.
  bool stamp(FrameInfo& info) noexcept override;
  // Off: frames of what no board can trigger, a take or a simulation, stay as they are.
  void use(bool on) noexcept { used_.store(on, std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t stamped() const noexcept { return stamped_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t left() const noexcept { return left_.load(std::memory_order_relaxed); }

  static constexpr std::size_t kLater = 8;  // frames until a frame's strobe has surely come
  static constexpr std::size_t kAgreeing =
      8;  // frames in a row; one strobe in twenty lost: wrong once in 10¹⁰

 private:
  struct Seen {
    std::uint32_t sequence = 0;
    std::int64_t received_mono_ns = 0;
  };
  void learn(const FrameInfo& info) noexcept;

  const StrobeRing& strobes_;
  std::array<Seen, kLater> seen_{};
  std::uint64_t frames_ = 0;
  std::optional<std::uint32_t> lead_;  // trigger less sequence, once it is bound
  std::uint32_t candidate_ = 0;
  std::size_t agreeing_ = 0;  // frames in a row for the candidate
  std::atomic<bool> used_{true};
  std::atomic<std::uint64_t> stamped_{0}, left_{0};
};

}  // namespace lightwell
