// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/strobe_pairing.h"

#include <algorithm>
#include <utility>

namespace lightwell {

void StrobePairing::trigger(std::uint32_t n, std::int64_t mono_ns) {
  Trigger& oldest = triggers_[made_++ % kRemembered];
  if (!oldest.answered) ++unanswered_;
  oldest = {n, mono_ns, false};
}

StrobePairing::Trigger* StrobePairing::before(std::int64_t mono_ns) {
  for (std::size_t back = 1; back <= std::min(made_, kRemembered); ++back) {
    Trigger& trigger = triggers_[(made_ - back) % kRemembered];
    if (trigger.mono_ns <= mono_ns) return &trigger;
  }
  return nullptr;
}

std::optional<StrobedExposure> StrobePairing::edge(bool rises, std::int64_t mono_ns) {
  const std::optional<StrobedExposure> open = std::exchange(open_, std::nullopt);
  if (rises) {
    Trigger* trigger = before(mono_ns);
    if (trigger == nullptr || trigger->answered || mono_ns - trigger->mono_ns >= window_ns_) {
      ++strays_;
      return std::nullopt;
    }
    trigger->answered = true;
    open_ = StrobedExposure{trigger->n, mono_ns, mono_ns};
    return std::nullopt;
  }
  if (!open || mono_ns - open->begin_mono_ns > window_ns_) return std::nullopt;
  ++strobes_;
  return StrobedExposure{open->trigger, open->begin_mono_ns, mono_ns};
}

}  // namespace lightwell
