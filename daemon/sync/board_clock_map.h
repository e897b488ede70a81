// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

namespace lightwell {

// A PING and its PONG, nanoseconds of two clocks (interface/sync_protocol.h).
struct ClockExchange {
  std::int64_t sent_mono_ns = 0;       // t1
  std::int64_t received_board_ns = 0;  // t2
  std::int64_t sent_board_ns = 0;      // t3
  std::int64_t returned_mono_ns = 0;   // t4
};

// When something happened by the host's clock, that the board has stamped with its own.
//
// No delay is negative: the board's t2 lies after the host's t1, its t3 before t4. So every exchange bounds the line between
// the clocks from both sides, however long it was delayed, and a line far from all bounds is taken (Moon, Skelly and
// Towsley, INFOCOM 1999: there on one side, here between both). Late exchanges do no harm; what is
// left is half the difference of the smallest delays there and back, which no exchange of messages shows.
class BoardClockMap {
 public:
  // Exchanges that contradict those before (the board started anew, or its crystal jumped) begin a new map. False: refused,
  // its times are out of order.
  bool add(const ClockExchange& exchange);
  // Empty before the first exchange.
  [[nodiscard]] std::optional<std::int64_t> mono_ns(std::int64_t board_ns) const;
  // The board's clock against the host's: positive, the board's is faster. Ppm; 0 while the exchanges span under kFitNs.
  [[nodiscard]] double drift_ppm() const { return -slope_ * 1e6; }
  // The line is at most so far off at the last fit, by whatever line contradicts no exchange, while no clock wanders within
  // the window (a crystal within 100 ppm, before kFitNs). Infinite before the first exchange.
  [[nodiscard]] double bound_us() const;
  [[nodiscard]] std::size_t exchanges() const { return exchanges_.size(); }
  void reset() { *this = BoardClockMap(); }

  static constexpr std::int64_t kWindowNs = 60'000'000'000;
  static constexpr std::int64_t kFitNs = 2'000'000'000;

 private:
  // Of the host's clock less the board's, less what it is by the newest exchange of the fit, nanoseconds.
  struct Gap {
    double low = 0, high = 0;
    [[nodiscard]] double width() const { return high - low; }
  };
  [[nodiscard]] Gap gap_at(double slope) const;
  void fit();
  [[nodiscard]] double middle_ns() const { return (gap_.low + gap_.high) / 2; }

  std::deque<ClockExchange> exchanges_;
  ClockExchange origin_;  // of the fit
  std::size_t since_fit_ = 0;
  double slope_ = 0;
  Gap gap_;
  double bound_ns_ = 0;
};

}  // namespace lightwell
