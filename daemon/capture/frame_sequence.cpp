// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/frame_sequence.h"

#include <algorithm>

namespace lightwell {

std::uint64_t FrameSequence::distance(std::uint64_t frame_id) const noexcept {
  constexpr std::uint64_t kIds = 65535;  // ids 1…65535
  if (!has_last_ || frame_id == 0) return 0;
  if (frame_id > kIds || last_id_ > kIds) return frame_id > last_id_ ? frame_id - last_id_ : 0;
  const std::uint64_t forward = (frame_id + kIds - last_id_) % kIds;
  return forward <= kIds / 2 ? forward : 0;
}

FrameSequence::Step FrameSequence::next(std::uint64_t frame_id) noexcept {
  const std::uint64_t step = std::max<std::uint64_t>(distance(frame_id), 1);
  sequence_ += step;
  last_id_ = frame_id;
  has_last_ = true;
  // An incomplete frame without a name left a gap too; it has been counted already.
  const std::uint64_t lost = step - 1 - std::min(unnamed_, step - 1);
  unnamed_ = 0;
  return {sequence_, lost};
}

std::uint64_t FrameSequence::incomplete(std::uint64_t frame_id) noexcept {
  const std::uint64_t step = distance(frame_id);
  if (step == 0) {
    ++unnamed_;
    return 0;
  }
  const Step at = next(frame_id);
  return at.lost;
}

}  // namespace lightwell
