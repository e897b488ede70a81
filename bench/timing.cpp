// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cmath>

#include "bench/suite.h"

namespace lightwell::bench {
namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace

Timing timing_of(std::vector<double> ms) {
  std::sort(ms.begin(), ms.end());
  const auto at = [&](double q) {
    return ms[static_cast<std::size_t>(std::lround(q * static_cast<double>(ms.size() - 1)))];
  };
  return {at(0.1), at(0.5), at(0.99), ms.size()};
}

std::vector<Row> time_in_turns(const std::string& setting, std::vector<Case> cases, const Options& options,
                               const std::string& baseline, const Turns& turns) {
  std::vector<std::vector<double>> ms(cases.size());
  const auto start = Clock::now();
  const double budget_ms = 1000 * options.seconds_per_case * static_cast<double>(cases.size());
  std::size_t input = 0;
  while (ms_since(start) < budget_ms || ms.front().size() < turns.least_runs)
    for (std::size_t c = 0; c < cases.size(); ++c) {
      cases[c].run(input++);
      for (std::size_t i = 0; i < turns.in_a_row; ++i) {
        const auto begin = Clock::now();
        cases[c].run(input++);
        ms[c].push_back(ms_since(begin));
      }
    }
  std::vector<Row> rows;
  for (std::size_t c = 0; c < cases.size(); ++c)
    rows.push_back({setting, cases[c].name, timing_of(ms[c]), std::move(cases[c].values)});
  for (const Row& base : rows) {
    if (base.name != baseline) continue;
    const double p50 = base.timing.p50_ms;
    for (Row& row : rows) row.values.emplace_back("ratio_of_p50_to_" + baseline, row.timing.p50_ms / p50);
    break;
  }
  return rows;
}

}  // namespace lightwell::bench
