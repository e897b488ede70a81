// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lightwell {

// Samples of a tracker are stamped by its clock, their arrivals by ours. A network only adds to a delay, so that the least
// difference of the two around a sample is the best known between the clocks.

// Where a tracker's clock was set, as when it first hears of NTP or PTP.
struct ClockStep {
  std::size_t sample = 0;  // the first one after it
  std::int64_t by_ns = 0;  // above 0: forward; to within the network's delays
};

// The steps of more than 0.1 s, and all by which samples fall. arrivals_ns rise, samples_ns are as many.
// A forward step: a delay below all of the second before. Back: all of the second after are above it.
std::vector<ClockStep> clock_steps(std::span<const std::int64_t> arrivals_ns,
                                   std::span<const std::int64_t> samples_ns);

// The samples' times by our clock: moved by the least delay within ±5 s and between the same steps.
std::vector<std::int64_t> sample_times(std::span<const std::int64_t> arrivals_ns,
                                       std::span<const std::int64_t> samples_ns,
                                       std::span<const ClockStep> steps);

}  // namespace lightwell
