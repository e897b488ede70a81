// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/board_clock_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lightwell {
namespace {

constexpr double kSteepest = 500e-6;  // no crystal is so far off
constexpr double kUsual = 100e-6;     // nor a usual one so far
constexpr double kTop = 0.98;         // of the widest gap
constexpr int kSteps = 32;            // of the golden section: 500 ppm to 1e-4 ppm
constexpr std::size_t kMost = 2400;   // exchanges kept; a window at 40 a second
constexpr std::size_t kFitEvery =
    8;  // exchanges, once there are many: a fit of 2400 takes a third of a millisecond
constexpr std::size_t kMany = 64;

// Where a concave function is highest between two places.
template <class Function>
double highest(double low, double high, const Function& f) {
  const double section = (std::sqrt(5.0) - 1) / 2;
  double a = high - section * (high - low), b = low + section * (high - low);
  double f_a = f(a), f_b = f(b);
  for (int i = 0; i < kSteps; ++i) {
    if (f_a < f_b) {
      low = a, a = b, f_a = f_b;
      b = low + section * (high - low);
      f_b = f(b);
    } else {
      high = b, b = a, f_b = f_a;
      a = high - section * (high - low);
      f_a = f(a);
    }
  }
  return (low + high) / 2;
}

// The last place on the way to an end where a concave function is no less than something.
template <class Function>
double last_above(double from, double end, double least, const Function& f) {
  if (f(end) >= least) return end;
  for (int i = 0; i < kSteps / 2; ++i) {
    const double middle = (from + end) / 2;
    (f(middle) >= least ? from : end) = middle;
  }
  return from;
}

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

// The gap's width is a concave function of the slope: the least of straight lines. Where few exchanges were fast it is flat
// about its top, and any slope there is as likely: the middle of those that are left is taken.
void BoardClockMap::fit() {
  origin_ = exchanges_.back();
  since_fit_ = 0;
  const std::int64_t span = origin_.sent_board_ns - exchanges_.front().sent_board_ns;
  const double steepest = span < kFitNs ? kUsual : kSteepest;
  const auto width = [&](double slope) { return gap_at(slope).width(); };
  const double best = span < kFitNs ? 0 : highest(-steepest, steepest, width);
  const double most = width(best);
  if (!(most > 0)) {
    slope_ = best;
    gap_ = gap_at(best);
    bound_ns_ = -1;
    return;
  }
  const auto reach = [&](double end, double least) { return last_above(best, end, least, width); };
  slope_ = span < kFitNs ? 0 : (reach(-steepest, kTop * most) + reach(steepest, kTop * most)) / 2;
  gap_ = gap_at(slope_);
  // Any line of any slope that contradicts no exchange may be the true one.
  const double flattest = reach(-steepest, 0), steep = reach(steepest, 0);
  const double high = gap_at(highest(flattest, steep, [&](double slope) { return gap_at(slope).high; })).high;
  const double low = gap_at(highest(flattest, steep, [&](double slope) { return -gap_at(slope).low; })).low;
  bound_ns_ = std::max(high - middle_ns(), middle_ns() - low);
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
         std::llround(middle_ns() + slope_ * since);
}

double BoardClockMap::bound_us() const {
  return exchanges_.empty() ? std::numeric_limits<double>::infinity() : bound_ns_ * 1e-3;
}

}  // namespace lightwell
