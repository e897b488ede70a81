// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <ctime>

namespace lightwell {

inline std::int64_t clock_ns(clockid_t clock) noexcept {
  timespec t{};
  clock_gettime(clock, &t);
  return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}
inline std::int64_t mono_now_ns() noexcept {
  return clock_ns(CLOCK_MONOTONIC);
}
inline std::int64_t utc_now_ns() noexcept {
  return clock_ns(CLOCK_REALTIME);
}

}  // namespace lightwell
