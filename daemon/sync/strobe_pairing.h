// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "daemon/sync/strobe_ring.h"

namespace lightwell {

// Which trigger an exposure answers, where this machine makes the triggers itself: the strobe's rise belongs to the last
// trigger before it, within a window, its fall to its rise. What would be a guess is left out. Times by CLOCK_MONOTONIC.
class StrobePairing {
 public:
  // window_ns: a strobe rises so soon after its trigger, and lasts no longer; a trigger's period, usually.
  explicit StrobePairing(std::int64_t window_ns) : window_ns_(window_ns) {}

  // In order, each before the edges that answer it.
  void trigger(std::uint32_t n, std::int64_t mono_ns);
  // The exposure that this edge ends, if it ends one.
  std::optional<StrobedExposure> edge(bool rises, std::int64_t mono_ns);

  [[nodiscard]] std::uint32_t strobes() const { return strobes_; }
  [[nodiscard]] std::uint32_t strays() const { return strays_; }  // rises without a trigger
  [[nodiscard]] std::uint32_t unanswered() const {
    return unanswered_;
  }  // triggers long past, without a rise

  static constexpr std::size_t kRemembered = 64;  // triggers, while their edges wait to be read

 private:
  struct Trigger {
    std::uint32_t n = 0;
    std::int64_t mono_ns = 0;
    bool answered = true;
  };
  Trigger* before(std::int64_t mono_ns);

  std::int64_t window_ns_;
  std::array<Trigger, kRemembered> triggers_;
  std::size_t made_ = 0;
  std::optional<StrobedExposure> open_;  // risen, not fallen
  std::uint32_t strobes_ = 0, strays_ = 0, unanswered_ = 0;
};

}  // namespace lightwell
