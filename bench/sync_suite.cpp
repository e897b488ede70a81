// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "bench/suite.h"
#include "bench/sync_peers.h"
#include "firmware/core/flicker.h"
#include "firmware/core/servo.h"
#include "firmware/core/strobe.h"

// The sync board's mathematics and the host's, in simulated time: error against the truth, and the time a call takes here.
namespace lightwell::bench {
namespace {

constexpr double kTickHz = 84e6;

double rms(double squares, std::size_t count) {
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(count, 1)));
}

// ---- two clocks, 40 exchanges a second, a millisecond of scheduling noise each way

constexpr double kDriftPpm = 37;

std::vector<ClockExchange> exchanges_of(unsigned seed, double seconds) {
  std::mt19937 random(seed);
  std::exponential_distribution<double> delay(1e-6);
  const auto board = [](double mono_ns) { return std::llround(mono_ns * (1 + kDriftPpm * 1e-6) + 5e9); };
  std::vector<ClockExchange> all;
  for (double t = 1e9; t < (1 + seconds) * 1e9; t += 25e6) {
    const double received = t + 60e3 + delay(random), answered = received + 20e3;
    all.push_back(
        {std::llround(t), board(received), board(answered), std::llround(answered + 60e3 + delay(random))});
  }
  return all;
}

double true_mono_ns(double board_ns) {
  return (board_ns - 5e9) / (1 + kDriftPpm * 1e-6);
}

template <class Map, class Ask>
Case clock_case(const std::string& name, const Ask& ask) {
  double squares = 0, worst = 0, drift = 0;
  std::size_t count = 0;
  constexpr unsigned kSeeds = 8;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    Map map;
    const auto all = exchanges_of(seed, 60);
    for (std::size_t i = 0; i < all.size(); ++i) {
      map.add(all[i]);
      if (i < 200) continue;                                                     // five seconds
      const double board_ns = static_cast<double>(all[i].sent_board_ns) + 10e6;  // a strobe a little later
      const double error = (ask(map, board_ns) - true_mono_ns(board_ns)) * 1e-3;
      squares += error * error;
      worst = std::max(worst, std::abs(error));
      ++count;
    }
    drift = std::max(drift, std::abs(map.drift_ppm() - kDriftPpm));
  }
  const auto all = std::make_shared<std::vector<ClockExchange>>(exchanges_of(99, 60));
  const auto map = std::make_shared<Map>();
  const auto at = std::make_shared<std::size_t>(0);
  return {name,
          [all, map, at](std::size_t) {
            for (int i = 0; i < 40; ++i) {
              if (*at == all->size()) *at = 0, *map = Map();
              map->add((*all)[(*at)++]);
            }
          },
          {{"rms_us", rms(squares, count)},
           {"worst_us", worst},
           {"worst_drift_error_ppm_after_a_minute", drift}}};
}

std::vector<Row> clock_rows(const Options& options) {
  const auto ours = [](const BoardClockMap& map, double board_ns) {
    return static_cast<double>(*map.mono_ns(std::llround(board_ns)));
  };
  const auto theirs = [](const auto& map, double board_ns) { return map.mono_ns(board_ns); };
  return time_in_turns("clock of the board, a second of exchanges",
                       {clock_case<BoardClockMap>("Lightwell", ours),
                        clock_case<RegressionClock>("least squares of a minute", theirs),
                        clock_case<NtpClock>("NTP's clock filter", theirs)},
                       options, "Lightwell", {60, 240});
}

// ---- a reference 100 ppm off, 200 ns of capture noise

struct Servo {
  explicit Servo(double hz) {
    servo_follow(&state, static_cast<std::uint32_t>(kTickHz), static_cast<std::uint32_t>(hz), 1);
  }
  void edge(double tick) {
    const auto at = static_cast<std::uint64_t>(std::llround(tick));
    servo_edge(&state, at);
    servo_advance(&state, at + static_cast<std::uint64_t>(kTickHz / 1000));
  }
  // Less the edge that comes next, ticks.
  [[nodiscard]] double error_of(double next) const {
    if (!servo_holds(&state)) return std::numeric_limits<double>::infinity();
    const timeline& line = state.held.line;
    const double period = static_cast<double>(timeline_period_q32(&line)) / 4294967296.0;
    return std::remainder(next - static_cast<double>(line.base) - line.base_part / 4294967296.0, period);
  }
  servo state{};
};
struct Loop : PhaseLoop {
  explicit Loop(double hz) : PhaseLoop(kTickHz, hz) {}
  [[nodiscard]] double error_of(double tick) const { return tick - next(); }
};

template <class Follower>
Case servo_case(const std::string& name, double hz) {
  double squares = 0, settled_s = 0;
  std::size_t count = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> noise(0, 200e-9 * kTickHz);
    Follower follower(hz);
    double last_bad_s = 0;
    for (std::uint64_t n = 0; n < static_cast<std::uint64_t>(30 * hz); ++n) {
      const auto truth = [&](std::uint64_t edge) {
        return (0.01 + static_cast<double>(edge) / hz / (1 + 100e-6)) * kTickHz;
      };
      follower.edge(truth(n) + noise(random));
      const double error_us = follower.error_of(truth(n + 1)) / kTickHz * 1e6;
      const double s = truth(n) / kTickHz;
      if (std::abs(error_us) > 3) last_bad_s = s;
      if (s < 15) continue;
      squares += error_us * error_us;
      ++count;
    }
    settled_s = std::max(settled_s, last_bad_s);
  }
  const auto follower = std::make_shared<Follower>(hz);
  const auto tick = std::make_shared<double>(1e6);
  return {name,
          [follower, tick, hz](std::size_t) { follower->edge(*tick += kTickHz / hz / (1 + 100e-6)); },
          {{"rms_us_from_15_s", rms(squares, count)}, {"s_until_within_3_us_for_good", settled_s}}};
}

std::vector<Row> servo_rows(const Options& options) {
  std::vector<Row> rows;
  for (const double hz : {1.0, 60.0})
    for (Row& row : time_in_turns(
             "reference of " + std::to_string(static_cast<int>(hz)) + " Hz, an edge",
             {servo_case<Servo>("Lightwell", hz), servo_case<Loop>("proportional-integral loop", hz)},
             options, "Lightwell", {1000, 20000}))
      rows.push_back(std::move(row));
  return rows;
}

// ---- a lamp of 2 % depth in noise as strong, two seconds of samples

constexpr double kSampleHz = 8000;

std::vector<double> lamp_codes(double hz, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> codes;
  for (int i = 0; i < FLICKER_SAMPLES; ++i)
    codes.push_back(
        std::round(1600 * (1 + 0.02 * std::cos(2 * 3.14159265358979323846 * hz * i / kSampleHz + seed) +
                           0.02 * normal(random))));
  return codes;
}

Tone measured_tone(const std::vector<double>& codes) {
  static flicker meter;
  flicker_init(&meter, static_cast<float>(kSampleHz), 0, 4095);
  flicker_result result{};
  for (const double code : codes)
    if (flicker_sample(&meter, static_cast<std::uint16_t>(code), &result)) break;
  return result.tones > 0 ? Tone{result.tone[0].hz, result.tone[0].depth} : Tone{};
}

Case lamp_case(const std::string& name, const std::function<Tone(const std::vector<double>&)>& measure) {
  double worst_hz = 0, worst_depth = 0;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(80.5, 1999.5);
  for (unsigned i = 0; i < 100; ++i) {
    const double hz = any(random);
    const Tone tone = measure(lamp_codes(hz, i));
    worst_hz = std::max(worst_hz, std::abs(tone.hz - hz));
    worst_depth = std::max(worst_depth, std::abs(tone.depth / 0.02 - 1));
  }
  const auto codes = std::make_shared<std::vector<double>>(lamp_codes(100.04, 1));
  return {name,
          [codes, measure](std::size_t) { measure(*codes); },
          {{"worst_hz", worst_hz}, {"worst_depth_relative", worst_depth}}};
}

std::vector<Row> lamp_rows(const Options& options) {
  return time_in_turns(
      "lamp of 2 %, two seconds",
      {lamp_case("Lightwell", measured_tone),
       lamp_case("largest bin of one transform",
                 [](const std::vector<double>& codes) { return largest_bin(codes, kSampleHz, 80); })},
      options, "Lightwell");
}

// ---- a million frames, one trigger and one strobe in twenty lost

Row strobe_row() {
  constexpr std::uint64_t kPeriod = 84'000'000 / 60;
  std::mt19937_64 random(1);
  strobe self{};
  strobe_init(&self, 840'000, kPeriod, 4'200);
  strobe_report report{};
  std::size_t wrong = 0, paired = 0, in_order_wrong = 0;
  std::uint32_t counted = 0;
  std::uint64_t rise_of_trigger = 0;
  const auto check = [&](std::uint32_t n) {
    if (!report.paired) return;
    ++paired;
    wrong += report.n != n || report.rise != rise_of_trigger ? 1 : 0;
  };
  for (std::uint32_t n = 0; n < 1'000'000; ++n) {
    const std::uint64_t tick = 1000 + n * kPeriod;
    strobe_trigger(&self, n, tick);
    if (random() % 20 == 0 || random() % 20 == 0)
      continue;  // the camera missed it, or its strobe was not seen
    rise_of_trigger = tick + 2000 + random() % 400'000;
    if (strobe_edge(&self, rise_of_trigger, true, &report)) check(n - 1);
    if (strobe_edge(&self, rise_of_trigger + 336'000, false, &report)) check(n);
    if (strobe_poll(&self, tick + kPeriod - 1, &report)) check(n);
    in_order_wrong += counted++ != n ? 1 : 0;  // who counts strobes as they come
  }
  return {"strobes of a million frames",
          "Lightwell",
          {},
          {{"wrong", static_cast<double>(wrong)},
           {"paired", static_cast<double>(paired)},
           {"wrong_if_counted_as_they_come", static_cast<double>(in_order_wrong)}}};
}

}  // namespace

std::vector<Row> sync_suite(const Options& options) {
  std::vector<Row> rows;
  for (const auto& part : {clock_rows, servo_rows, lamp_rows})
    for (Row& row : part(options)) rows.push_back(std::move(row));
  rows.push_back(strobe_row());
  return rows;
}

}  // namespace lightwell::bench
