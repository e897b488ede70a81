// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>

#include "daemon/pipeline/pipeline.h"
#include "interface/timecode.h"

namespace lightwell {

// Gives each frame the timecode in which the middle of its exposure lies. Words of LTC come from the board's thread after
// their frame has ended, so the last one is counted on from; a source that falls silent is believed for two seconds.
class TimecodeStamper final : public FrameStamper {
 public:
  // A word and the beginning of the frame that it names, by CLOCK_MONOTONIC. Any thread, in order.
  void word(const Timecode& timecode, std::int64_t start_mono_ns) noexcept;
  // Sets info.timecode where one is known and the frame brings none; false where not. Frame path only.
  bool stamp(FrameInfo& info) noexcept override;
  // Off: a take has the timecode of its day, or none.
  void use(bool on) noexcept { used_.store(on, std::memory_order_relaxed); }

  static constexpr std::int64_t kBelievedNs = 2'000'000'000;

 private:
  struct Word {
    Timecode timecode;
    std::int64_t start_mono_ns = 0;
    double period_ns = 0;     // of a frame, followed
    int frames_a_second = 0;  // that its numbers count to
  };
  std::mutex mutex_;  // held for a copy; a frame that finds it taken uses the word before
  std::optional<Word> newest_;
  Word used_word_;    // frame path's own
  bool any_ = false;  // it is one
  std::atomic<bool> used_{true};
};

}  // namespace lightwell
