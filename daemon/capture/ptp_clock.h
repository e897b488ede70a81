// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace lightwell {

// Says whether a camera whose clock PTP (IEEE 1588) keeps counts the time that this machine counts. Frames' times do not
// depend on it: cameras stamp different instants of the exposure, and DeviceClock finds out which. It is what makes
// stamps of several cameras and machines comparable.
// Not thread-safe. received: of the frame, by this machine's TAI or UTC, either of which a PTP domain may hold.
class PtpClock {
 public:
  void saw(std::uint64_t t_device_ns, std::int64_t received_tai_ns, std::int64_t received_utc_ns) noexcept;
  // status: the camera's word, empty where it has no PTP or it is off, and then so is the answer.
  // host_is_kept: something disciplines this machine's clock.
  [[nodiscard]] std::string words(const std::string& status, bool host_is_kept) const;

 private:
  bool seen_ = false;
  std::int64_t least_delay_ns_ =
      0;  // reception − stamp of this window's and the last window's quickest frame
  std::int64_t window_least_ns_ = 0;
  std::int64_t window_start_ns_ = 0;
};

// The kernel's word (adjtimex): NTP or PTP disciplines CLOCK_REALTIME.
bool host_clock_is_kept();

}  // namespace lightwell
