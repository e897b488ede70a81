// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/tracker_clock.h"

#include <algorithm>
#include <deque>

namespace lightwell {
namespace {

constexpr std::int64_t kLeastStep_ns = 100'000'000;  // above what a local network delays
constexpr std::int64_t kLook_ns = 1'000'000'000;     // to tell a step from a delay
constexpr std::int64_t kWindow_ns = 5'000'000'000;

// The least of the delays that came within the last kLook_ns before a sample's predecessor.
class LeastDelay {
 public:
  void add(std::int64_t arrival_ns, std::int64_t delay_ns) {
    while (!least_.empty() && least_.back().second >= delay_ns) least_.pop_back();
    least_.emplace_back(arrival_ns, delay_ns);
    while (arrival_ns - least_.front().first > kLook_ns) least_.pop_front();
  }
  void forget() { least_.clear(); }
  [[nodiscard]] std::int64_t ns() const { return least_.front().second; }

 private:
  std::deque<std::pair<std::int64_t, std::int64_t>> least_;  // arrival and delay, both rising
};

}  // namespace

std::vector<ClockStep> clock_steps(std::span<const std::int64_t> arrivals_ns,
                                   std::span<const std::int64_t> samples_ns) {
  std::vector<ClockStep> steps;
  LeastDelay least;
  std::size_t not_back_before = 0;  // there is a sample that is not late before this one
  for (std::size_t i = 0; i < samples_ns.size(); ++i) {
    const std::int64_t delay = arrivals_ns[i] - samples_ns[i];
    if (i > 0) {
      const std::int64_t late = least.ns() + kLeastStep_ns;
      bool step = samples_ns[i] <= samples_ns[i - 1] || delay < least.ns() - kLeastStep_ns;
      if (!step && delay > late && i >= not_back_before) {
        std::size_t j = i;
        while (j < samples_ns.size() && arrivals_ns[j] - arrivals_ns[i] < kLook_ns &&
               arrivals_ns[j] - samples_ns[j] > late)
          ++j;
        step = j < samples_ns.size() && arrivals_ns[j] - samples_ns[j] > late;
        if (!step) not_back_before = j;
      }
      if (step) {
        steps.push_back({i, least.ns() - delay});
        least.forget();
        not_back_before = 0;
      }
    }
    least.add(arrivals_ns[i], delay);
  }
  return steps;
}

std::vector<std::int64_t> sample_times(std::span<const std::int64_t> arrivals_ns,
                                       std::span<const std::int64_t> samples_ns,
                                       std::span<const ClockStep> steps) {
  std::vector<std::int64_t> times(samples_ns.size());
  for (std::size_t s = 0; s <= steps.size(); ++s) {
    const std::size_t from = s == 0 ? 0 : steps[s - 1].sample;
    const std::size_t to = s == steps.size() ? samples_ns.size() : steps[s].sample;
    const auto delay = [&](std::size_t i) { return arrivals_ns[i] - samples_ns[i]; };
    std::deque<std::size_t> least;  // of the window, rising from the front
    std::size_t begin = from, end = from;
    for (std::size_t i = from; i < to; ++i) {
      for (; end < to && samples_ns[end] - samples_ns[i] <= kWindow_ns; ++end) {
        while (!least.empty() && delay(least.back()) >= delay(end)) least.pop_back();
        least.push_back(end);
      }
      for (; samples_ns[i] - samples_ns[begin] > kWindow_ns; ++begin)
        if (least.front() == begin) least.pop_front();
      times[i] = samples_ns[i] + delay(least.front());
    }
  }
  return times;
}

}  // namespace lightwell
