// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/ptp_clock.h"

#include <fmt/format.h>
#include <sys/timex.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace lightwell {
namespace {

constexpr std::int64_t kWindowNs = 10'000'000'000;
constexpr std::int64_t kSecond = 1'000'000'000;

bool is_locked(const std::string& status) {
  // A master keeps the time that others follow.
  return status == "Slave" || status == "Master" || status == "Grandmaster";
}

}  // namespace

void PtpClock::saw(std::uint64_t t_device_ns, std::int64_t received_tai_ns,
                   std::int64_t received_utc_ns) noexcept {
  const auto stamp = static_cast<std::int64_t>(t_device_ns);
  const std::int64_t by_tai = received_tai_ns - stamp, by_utc = received_utc_ns - stamp;
  const std::int64_t delay = std::llabs(by_tai) < std::llabs(by_utc) ? by_tai : by_utc;
  if (!seen_ || received_utc_ns - window_start_ns_ > kWindowNs || received_utc_ns < window_start_ns_) {
    least_delay_ns_ = seen_ ? window_least_ns_ : delay;
    window_least_ns_ = delay;
    window_start_ns_ = received_utc_ns;
    seen_ = true;
  }
  window_least_ns_ = std::min(window_least_ns_, delay);
  least_delay_ns_ = std::min(least_delay_ns_, delay);
}

std::string PtpClock::words(const std::string& status, bool host_is_kept) const {
  if (status.empty()) return {};
  const std::string out = "PTP " + status;
  if (!is_locked(status)) return out;
  if (!host_is_kept) return out + ", this machine's clock is kept by nothing";
  if (!seen_) return out;
  // No frame arrives before it was stamped, and none that is whole a second after.
  if (least_delay_ns_ < 0 || least_delay_ns_ > kSecond)
    return out + fmt::format(", {:.4g} s {} this machine's clock",
                             std::round(std::abs(static_cast<double>(least_delay_ns_)) * 1e-8) / 10,
                             least_delay_ns_ < 0 ? "ahead of" : "behind");
  // In steps, so that the line does not change with every frame.
  double at_most_ms = 0.1;
  while (at_most_ms * 1e6 < static_cast<double>(least_delay_ns_)) at_most_ms *= at_most_ms < 1 ? 10 : 2;
  return out + fmt::format(", in step with this machine's clock to {:g} ms", at_most_ms);
}

bool host_clock_is_kept() {
  timex now{};
  return ::adjtimex(&now) >= 0 && (now.status & STA_UNSYNC) == 0;
}

}  // namespace lightwell
