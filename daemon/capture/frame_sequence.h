// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace lightwell {

// Turns a camera's frame ids into one count that never repeats, across wraps and reconnections.
// GigE Vision ids (version 2.0, section 23): 16 bit, starting anywhere, 65535 is followed by 1, 0 means none;
// devices with extended ids count in 64 bit. Ids that jump back are a device that began anew: counting goes
// on by one. not thread-safe, allocates nothing
class FrameSequence {
 public:
  struct Step {
    std::uint64_t sequence = 0;  // 0 for the first frame
    std::uint64_t lost = 0;      // frames between the one before and this one that never came
  };
  // A whole frame.
  Step next(std::uint64_t frame_id) noexcept;
  // A frame with packets missing; its id is 0 or an old one where the leader was among them.
  // Returns the frames lost before it.
  std::uint64_t incomplete(std::uint64_t frame_id) noexcept;
  // Ids start anew; what happened in between is unknown and counts as nothing.
  void reconnected() noexcept {
    has_last_ = false;
    unnamed_ = 0;
  }

 private:
  // Steps from the last id to this one; 0 for an id that is not after it.
  [[nodiscard]] std::uint64_t distance(std::uint64_t frame_id) const noexcept;

  std::uint64_t last_id_ = 0;
  bool has_last_ = false;
  std::uint64_t sequence_ = ~std::uint64_t{0};  // of the last frame; one before 0
  std::uint64_t unnamed_ = 0;                   // incomplete frames without an id since the last id
};

}  // namespace lightwell
