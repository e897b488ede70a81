// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/flicker_follower.h"

#include <cmath>

namespace lightwell {
namespace {

constexpr double kSameLampHz = 0.5;                       // mains wander by less
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

std::optional<TriggerChoice> FlickerFollower::consider(const sync_photodiode& seen,
                                                       std::int64_t now_mono_ns) {
  if (changed_ && now_mono_ns - changed_mono_ns_ < kSettleNs) return std::nullopt;
  if ((seen.flags & SYNC_PHOTODIODE_CLIPPED) != 0) return std::nullopt;  // its depths are unsure
  const bool any_lamp = seen.frequencies > 0;
  const double lamp_hz = any_lamp ? seen.frequency_mhz[0] * 1e-3 : 0;
  if (follows()) {
    if (any_lamp && std::abs(lamp_hz - lamp_hz_) < kSameLampHz) return std::nullopt;
    return change_to(wanted_, now_mono_ns);
  }
  if (!any_lamp || (seen.flags & SYNC_PHOTODIODE_ADVICE) == 0) return std::nullopt;
  const TriggerChoice advised{seen.rate_mhz * 1e-3, seen.exposure_ns * 1e-3};
  if (!(advised.rate_hz > 0) || !(advised.exposure_us > 0)) return std::nullopt;
  if (nearly(advised.rate_hz, wanted_.rate_hz, kSameRate) &&
      nearly(advised.exposure_us, wanted_.exposure_us, kSameExposure))
    return std::nullopt;
  lamp_hz_ = lamp_hz;
  return change_to(advised, now_mono_ns);
}

}  // namespace lightwell
