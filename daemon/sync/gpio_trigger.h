// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <thread>

#include "daemon/sync/gpio_line.h"

namespace lightwell {

struct TriggerPulses {
  std::uint32_t rate_numerator = 25, rate_denominator = 1;  // a second, exactly
  std::uint32_t pulse_ns = 500'000;                         // below half a period
  [[nodiscard]] std::int64_t period_ns() const { return due_ns(1); }
  // When the k-th is due, after the first.
  [[nodiscard]] std::int64_t due_ns(std::uint64_t k) const {
    return static_cast<std::int64_t>(static_cast<unsigned __int128>(k) * 1'000'000'000 * rate_denominator /
                                     rate_numerator);
  }
};

// Trigger pulses on a line, by a thread that wakes at absolute times, with real-time priority where the system allows it.
// A pulse that is half a period late is left out, and its number with it. What the scheduler adds is in the pulse: the sync
// board's timer is good to nanoseconds, this to tens of microseconds at best.
class GpioTrigger {
 public:
  GpioTrigger(std::unique_ptr<GpioOutput> line, const TriggerPulses& pulses);
  ~GpioTrigger();
  GpioTrigger(const GpioTrigger&) = delete;
  GpioTrigger& operator=(const GpioTrigger&) = delete;

  struct Made {
    std::uint32_t n = 0;
    std::int64_t mono_ns = 0;  // just before the line rises
  };
  // The next that was made, in order; one reader. Those that were not fetched in time are gone.
  std::optional<Made> next() noexcept;

  struct View {
    std::uint32_t made = 0, late = 0;  // late: left out
    std::int32_t late_ns = 0;          // the last pulse, after it was due
    double late_rms_ns = 0;            // over about the last 16
    bool real_time = false;
    bool failed = false;  // the line is gone
  };
  [[nodiscard]] View view() const noexcept;

 private:
  void run();
  bool pulse(std::int64_t due_mono_ns, std::uint32_t n);
  // False: stopped.
  bool sleep_until(std::int64_t mono_ns) const;

  static constexpr std::size_t kKept = 64;

  std::unique_ptr<GpioOutput> line_;
  TriggerPulses pulses_;
  std::array<Made, kKept> kept_;
  std::atomic<std::uint32_t> put_{0}, taken_{0};  // of kept_
  std::atomic<std::uint32_t> made_{0}, late_{0};
  std::atomic<std::int32_t> late_ns_{0};
  std::atomic<double> mean_square_{0};
  std::atomic<bool> real_time_{false}, failed_{false}, stopping_{false};
  std::thread thread_;
};

}  // namespace lightwell
