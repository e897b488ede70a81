// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "interface/sync_protocol.h"

namespace lightwell {

struct TriggerChoice {
  double rate_hz = 0;
  double exposure_us = 0;
  bool operator==(const TriggerChoice&) const = default;
};

// Takes the board's advice on lamps that beat with the trigger, and takes it back when the lamp is gone. The advice starts
// from what the board was told last, so it is taken only from the settings that were wanted: otherwise one lamp after
// another would lead further and further away from them.
class FlickerFollower {
 public:
  explicit FlickerFollower(const TriggerChoice& wanted) : wanted_(wanted), current_(wanted) {}

  // What to use from now on; empty: nothing changes.
  std::optional<TriggerChoice> consider(const sync_photodiode& seen, std::int64_t now_mono_ns);
  [[nodiscard]] const TriggerChoice& current() const { return current_; }
  [[nodiscard]] bool follows() const { return current_ != wanted_; }

  // The board looks at 2 s of light: what it says earlier was said of other settings.
  static constexpr std::int64_t kSettleNs = 5'000'000'000;

 private:
  [[nodiscard]] std::optional<TriggerChoice> change_to(const TriggerChoice& choice, std::int64_t now_mono_ns);

  TriggerChoice wanted_, current_;
  struct Lamp {
    double hz = 0, depth = 0;
  };
  [[nodiscard]] bool known(const Lamp& lamp) const;

  std::vector<Lamp> lamps_;  // for whose sake current_ is not wanted_
  std::int64_t changed_mono_ns_ = 0;
  bool changed_ = false;
};

}  // namespace lightwell
