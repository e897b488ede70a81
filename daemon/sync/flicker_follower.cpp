// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/flicker_follower.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace lightwell {
namespace {

constexpr double kSameLampHz = 0.5;                       // mains wander by less
constexpr double kOutshines = 1.5;                        // in depth, the deepest of those known
constexpr double kSameRate = 2e-4, kSameExposure = 5e-3;  // relative: not worth a change

bool nearly(double a, double b, double relative) {
  return std::abs(a - b) <= relative * b;
}

}  // namespace

std::optional<TriggerChoice> FlickerFollower::change_to(const TriggerChoice& choice,
                                                        std::int64_t now_mono_ns) {
  current_ = choice;
  changed_ = true;
  changed_mono_ns_ = now_mono_ns;
  return choice;
}

bool FlickerFollower::known(const Lamp& lamp) const {
  return std::any_of(lamps_.begin(), lamps_.end(),
                     [&](const Lamp& other) { return std::abs(other.hz - lamp.hz) < kSameLampHz; });
}

std::optional<TriggerChoice> FlickerFollower::consider(const sync_photodiode& seen,
                                                       std::int64_t now_mono_ns) {
  if (changed_ && now_mono_ns - changed_mono_ns_ < kSettleNs) return std::nullopt;
  if ((seen.flags & SYNC_PHOTODIODE_CLIPPED) != 0) return std::nullopt;  // its depths are unsure
  std::vector<Lamp> lamps;
  for (std::size_t i = 0; i < std::min<std::size_t>(seen.frequencies, SYNC_MAX_FREQUENCIES); ++i)
    lamps.push_back({seen.frequency_mhz[i] * 1e-3, seen.depth_ppm[i] * 1e-6});
  if (follows()) {
    // Lamps of like strength change places in the list; only one that outshines those known is another light.
    const auto is_known = [&](const Lamp& lamp) { return known(lamp); };
    const bool still_there = std::any_of(lamps.begin(), lamps.end(), is_known);
    const bool newcomer = std::any_of(lamps.begin(), lamps.end(), [&](const Lamp& lamp) {
      return !known(lamp) && lamp.depth > kOutshines * lamps_.front().depth;
    });
    if (still_there && !newcomer) return std::nullopt;
    return change_to(wanted_, now_mono_ns);
  }
  if (lamps.empty() || (seen.flags & SYNC_PHOTODIODE_ADVICE) == 0) return std::nullopt;
  const TriggerChoice advised{seen.rate_mhz * 1e-3, seen.exposure_ns * 1e-3};
  if (!(advised.rate_hz > 0) || !(advised.exposure_us > 0)) return std::nullopt;
  if (nearly(advised.rate_hz, wanted_.rate_hz, kSameRate) &&
      nearly(advised.exposure_us, wanted_.exposure_us, kSameExposure))
    return std::nullopt;
  lamps_ = std::move(lamps);
  return change_to(advised, now_mono_ns);
}

}  // namespace lightwell
