// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/exposure_stamper.h"

namespace lightwell {
namespace {

constexpr std::int64_t kOldestNs = 1'000'000'000;  // an exposure longer ago is no frame's that comes now

}  // namespace

void ExposureStamper::learn(const FrameInfo& info) noexcept {
  Seen& slot = seen_[frames_++ % kLater];
  const Seen earlier = slot;
  slot = {static_cast<std::uint32_t>(info.sequence), info.received_mono_ns};
  if (frames_ <= kLater) return;
  const auto exposure = strobes_.newest_before(earlier.received_mono_ns);
  if (!exposure || earlier.received_mono_ns - exposure->end_mono_ns > kOldestNs) return;
  const std::uint32_t lead = exposure->trigger - earlier.sequence;
  agreeing_ = lead == candidate_ ? agreeing_ + 1 : 1;
  candidate_ = lead;
  if (agreeing_ >= kAgreeing) lead_ = lead;
}

bool ExposureStamper::stamp(FrameInfo& info) noexcept {
  if (!used_.load(std::memory_order_relaxed)) return false;
  learn(info);
  const auto exposure =
      lead_ ? strobes_.find(*lead_ + static_cast<std::uint32_t>(info.sequence)) : std::nullopt;
  const std::int64_t since_ns = exposure ? info.received_mono_ns - exposure->end_mono_ns : -1;
  // A later exposure that had ended too: the camera has missed a trigger, and the lead no longer holds.
  const auto newest = strobes_.newest_before(info.received_mono_ns);
  if (since_ns < 0 || since_ns > kOldestNs || !newest || newest->trigger != exposure->trigger) {
    if (!strobes_.empty()) left_.fetch_add(1, std::memory_order_relaxed);
    return false;
  }
  const std::int64_t moved_ns = exposure->middle_mono_ns() - info.capture_mono_ns;
  info.capture_mono_ns += moved_ns;
  info.capture_utc_ns += moved_ns;
  stamped_.fetch_add(1, std::memory_order_relaxed);
  return true;
}

}  // namespace lightwell
