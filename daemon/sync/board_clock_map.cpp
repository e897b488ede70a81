// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/board_clock_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lightwell {
namespace {

constexpr double kSteepest = 500e-6;  // no crystal is so far off
constexpr int kSteps = 48;            // of the golden section: 500 ppm to far below 1e-6 ppm
constexpr std::size_t kMost = 2400;   // exchanges kept; a window at 40 a second
constexpr std::size_t kFitEvery =
    8;  // exchanges, once there are many: a fit of 2400 takes a third of a millisecond
constexpr std::size_t kMany = 64;

}  // namespace

// The line goes through the newest exchange's board time: what is near in time is what is asked for.
BoardClockMap::Gap BoardClockMap::gap_at(double slope) const {
  const std::int64_t origin_board = origin_.sent_board_ns;
  const std::int64_t origin = origin_.returned_mono_ns - origin_board;
  Gap gap{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  for (const ClockExchange& e : exchanges_) {
    const auto bound = [&](std::int64_t mono_ns, std::int64_t board_ns) {
      return static_cast<double>(mono_ns - board_ns - origin) -
             slope * static_cast<double>(board_ns - origin_board);
    };
    gap.low = std::max(gap.low, bound(e.sent_mono_ns, e.received_board_ns));
    gap.high = std::min(gap.high, bound(e.returned_mono_ns, e.sent_board_ns));
  }
  return gap;
}

// The gap's width is a concave function of the slope: the least of straight lines.
void BoardClockMap::fit() {
  origin_ = exchanges_.back();
  since_fit_ = 0;
  slope_ = 0;
  gap_ = gap_at(0);
  const std::int64_t span = exchanges_.back().sent_board_ns - exchanges_.front().sent_board_ns;
  if (span < kFitNs) return;
  const double section = (std::sqrt(5.0) - 1) / 2;
  double low = -kSteepest, high = kSteepest;
  double a = high - section * (high - low), b = low + section * (high - low);
  double width_a = gap_at(a).width(), width_b = gap_at(b).width();
  for (int i = 0; i < kSteps; ++i) {
    if (width_a < width_b) {
      low = a, a = b, width_a = width_b;
      b = low + section * (high - low);
      width_b = gap_at(b).width();
    } else {
      high = b, b = a, width_b = width_a;
      a = high - section * (high - low);
      width_a = gap_at(a).width();
    }
  }
  slope_ = (low + high) / 2;
  gap_ = gap_at(slope_);
}

bool BoardClockMap::add(const ClockExchange& exchange) {
  const ClockExchange& e = exchange;
  if (e.returned_mono_ns < e.sent_mono_ns || e.sent_board_ns < e.received_board_ns ||
      e.returned_mono_ns - e.sent_mono_ns < e.sent_board_ns - e.received_board_ns)
    return false;
  if (!exchanges_.empty() && e.received_board_ns <= exchanges_.back().sent_board_ns) reset();
  exchanges_.push_back(exchange);
  while (exchanges_.size() > kMost ||
         exchanges_.back().sent_mono_ns - exchanges_.front().sent_mono_ns > kWindowNs)
    exchanges_.pop_front();
  if (++since_fit_ < kFitEvery && exchanges_.size() >= kMany) return true;
  fit();
  // Old exchanges and new ones do not lie about one line: the old ones go, half by half.
  while (gap_.width() < 0 && exchanges_.size() > 1) {
    const auto half = static_cast<std::ptrdiff_t>((exchanges_.size() + 1) / 2);
    exchanges_.erase(exchanges_.begin(), exchanges_.begin() + half);
    if (exchanges_.empty()) exchanges_.push_back(exchange);
    fit();
  }
  return true;
}

std::optional<std::int64_t> BoardClockMap::mono_ns(std::int64_t board_ns) const {
  if (exchanges_.empty()) return std::nullopt;
  const double since = static_cast<double>(board_ns - origin_.sent_board_ns);
  return board_ns + (origin_.returned_mono_ns - origin_.sent_board_ns) +
         std::llround((gap_.low + gap_.high) / 2 + slope_ * since);
}

double BoardClockMap::bound_us() const {
  return exchanges_.empty() ? std::numeric_limits<double>::infinity() : gap_.width() / 2 * 1e-3;
}

}  // namespace lightwell
