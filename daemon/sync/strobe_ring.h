// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace lightwell {

// An exposure as the camera's strobe line showed it, by CLOCK_MONOTONIC.
struct StrobedExposure {
  std::uint32_t trigger = 0;  // counts the board's triggers, wraps
  std::int64_t begin_mono_ns = 0;
  std::int64_t end_mono_ns = 0;
  [[nodiscard]] std::int64_t middle_mono_ns() const {
    return begin_mono_ns + (end_mono_ns - begin_mono_ns) / 2;
  }
};

// The newest exposures, written by the board's thread and read by the frame path, which never waits: a slot that is being
// written counts as not there.
class StrobeRing {
 public:
  static constexpr std::size_t kSize = 64;  // half a second of a camera of 120 Hz

  void push(const StrobedExposure& exposure) noexcept {
    const std::uint64_t at = written_.load(std::memory_order_relaxed);
    Slot& slot = slots_[at % kSize];
    const std::uint64_t version = slot.version.load(std::memory_order_relaxed);
    slot.version.store(version + 1, std::memory_order_relaxed);  // odd: not whole
    std::atomic_thread_fence(std::memory_order_release);
    slot.trigger.store(exposure.trigger, std::memory_order_relaxed);
    slot.begin.store(exposure.begin_mono_ns, std::memory_order_relaxed);
    slot.end.store(exposure.end_mono_ns, std::memory_order_relaxed);
    slot.version.store(version + 2, std::memory_order_release);
    written_.store(at + 1, std::memory_order_release);
  }

  // Of this trigger; empty: not known, or no more.
  [[nodiscard]] std::optional<StrobedExposure> find(std::uint32_t trigger) const noexcept {
    return newest([=](const StrobedExposure& exposure) { return exposure.trigger == trigger; });
  }
  // The last exposure that had ended by then; empty: none is known.
  [[nodiscard]] std::optional<StrobedExposure> newest_before(std::int64_t mono_ns) const noexcept {
    return newest([=](const StrobedExposure& exposure) { return exposure.end_mono_ns <= mono_ns; });
  }
  [[nodiscard]] bool empty() const noexcept { return written_.load(std::memory_order_acquire) == 0; }

 private:
  struct Slot {
    std::atomic<std::uint64_t> version{0};
    std::atomic<std::uint32_t> trigger{0};
    std::atomic<std::int64_t> begin{0}, end{0};
  };
  template <class Fits>
  [[nodiscard]] std::optional<StrobedExposure> newest(const Fits& fits) const noexcept {
    const std::uint64_t written = written_.load(std::memory_order_acquire);
    const std::uint64_t known = written < kSize ? written : kSize;
    for (std::uint64_t back = 1; back <= known; ++back) {
      const auto exposure = read(slots_[(written - back) % kSize]);
      if (exposure && fits(*exposure)) return exposure;
    }
    return std::nullopt;
  }
  static std::optional<StrobedExposure> read(const Slot& slot) noexcept {
    const std::uint64_t version = slot.version.load(std::memory_order_acquire);
    const StrobedExposure exposure{slot.trigger.load(std::memory_order_relaxed),
                                   slot.begin.load(std::memory_order_relaxed),
                                   slot.end.load(std::memory_order_relaxed)};
    std::atomic_thread_fence(std::memory_order_acquire);
    if (version % 2 != 0 || version != slot.version.load(std::memory_order_relaxed)) return std::nullopt;
    return exposure;
  }

  std::array<Slot, kSize> slots_;
  std::atomic<std::uint64_t> written_{0};
};

}  // namespace lightwell
