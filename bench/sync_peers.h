// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// What the sync board's mathematics is compared with: the usual ways, each as its source has it.

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "daemon/sync/board_clock_map.h"

namespace lightwell::bench {

// The line of least squares through the offsets of the last minute, each taken for the middle of its exchange.
class RegressionClock {
 public:
  void add(const ClockExchange& e) {
    exchanges_.push_back(e);
    while (e.returned_mono_ns - exchanges_.front().returned_mono_ns > BoardClockMap::kWindowNs)
      exchanges_.pop_front();
    const ClockExchange& origin = exchanges_.back();
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (const ClockExchange& at : exchanges_) {
      const double x = static_cast<double>(at.sent_board_ns - origin.sent_board_ns);
      const double y = middle_offset(at) - middle_offset(origin);
      n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
    }
    const double spread = n * sxx - sx * sx;
    slope_ = spread > 0 ? (n * sxy - sx * sy) / spread : 0;
    at_ns_ = static_cast<double>(origin.sent_board_ns);
    offset_ns_ = middle_offset(origin) + (sy - slope_ * sx) / n;
  }
  [[nodiscard]] double mono_ns(double board_ns) const {
    return board_ns + offset_ns_ + slope_ * (board_ns - at_ns_);
  }
  [[nodiscard]] double drift_ppm() const { return -slope_ * 1e6; }

  static double middle_offset(const ClockExchange& e) {
    return 0.5 *
           static_cast<double>(e.sent_mono_ns - e.received_board_ns + e.returned_mono_ns - e.sent_board_ns);
  }

 private:
  std::deque<ClockExchange> exchanges_;
  double slope_ = 0, offset_ns_ = 0, at_ns_ = 0;
};

// NTP's clock filter (RFC 5905, section 10): of the last eight exchanges the one with the least delay counts; the drift is
// the slope between such offsets a minute apart.
class NtpClock {
 public:
  void add(const ClockExchange& e) {
    last_.push_back(e);
    if (last_.size() > 8) last_.pop_front();
    const auto delay = [](const ClockExchange& x) {
      return (x.returned_mono_ns - x.sent_mono_ns) - (x.sent_board_ns - x.received_board_ns);
    };
    const ClockExchange best =
        *std::min_element(last_.begin(), last_.end(), [&](auto& a, auto& b) { return delay(a) < delay(b); });
    if (history_.empty() || history_.back().sent_mono_ns != best.sent_mono_ns) history_.push_back(best);
    while (best.sent_mono_ns - history_.front().sent_mono_ns > BoardClockMap::kWindowNs) history_.pop_front();
    const double span = static_cast<double>(best.sent_board_ns - history_.front().sent_board_ns);
    const double change =
        RegressionClock::middle_offset(best) - RegressionClock::middle_offset(history_.front());
    slope_ = span > 2e9 ? change / span : 0;
    at_ns_ = static_cast<double>(best.sent_board_ns);
    offset_ns_ = RegressionClock::middle_offset(best);
  }
  [[nodiscard]] double mono_ns(double board_ns) const {
    return board_ns + offset_ns_ + slope_ * (board_ns - at_ns_);
  }
  [[nodiscard]] double drift_ppm() const { return -slope_ * 1e6; }

 private:
  std::deque<ClockExchange> last_, history_;
  double slope_ = 0, offset_ns_ = 0, at_ns_ = 0;
};

// A proportional-integral loop on the edges' phase, critically damped, of a tenth of their rate but at most 1 Hz.
class PhaseLoop {
 public:
  PhaseLoop(double tick_hz, double edge_hz) : period_(tick_hz / edge_hz) {
    const double turn =
        2 * 3.14159265358979323846 * std::min(0.1 * edge_hz, 1.0) / edge_hz;  // a loop's turn an edge
    proportional_ = 2 * 0.7071 * turn;
    integral_ = turn * turn;
  }
  void edge(double tick) {
    if (!begun_) next_ = tick, begun_ = true;
    const double error = tick - next_;
    period_ += integral_ * error;
    next_ += period_ + proportional_ * error;
  }
  [[nodiscard]] double next() const { return next_; }  // where the next edge is held to be

 private:
  double period_, next_ = 0, proportional_, integral_;
  bool begun_ = false;
};

struct Tone {
  double hz = 0, depth = 0;
};

// The largest bin of one transform of all samples under a Hann window: a resolution of half a hertz in two seconds.
inline Tone largest_bin(const std::vector<double>& codes, double sample_hz, double lowest_hz) {
  constexpr double kPi = 3.14159265358979323846;
  const std::size_t n = codes.size();
  double mean = 0;
  for (const double code : codes) mean += code / static_cast<double>(n);
  std::vector<std::complex<double>> in(n), out;
  for (std::size_t i = 0; i < n; ++i)
    in[i] =
        (codes[i] - mean) * (0.5 - 0.5 * std::cos(2 * kPi * static_cast<double>(i) / static_cast<double>(n)));
  Eigen::FFT<double> fft;
  fft.fwd(out, in);
  std::size_t best = static_cast<std::size_t>(lowest_hz * static_cast<double>(n) / sample_hz);
  for (std::size_t k = best; k < n / 2; ++k)
    if (std::abs(out[k]) > std::abs(out[best])) best = k;
  return {static_cast<double>(best) * sample_hz / static_cast<double>(n),
          4 * std::abs(out[best]) / static_cast<double>(n) / mean};
}

}  // namespace lightwell::bench
