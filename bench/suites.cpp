// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <utility>

#include "bench/coherence.h"
#include "bench/error_curves.h"
#include "bench/field_rows.h"
#include "bench/lights_suite.h"
#include "bench/render_suite.h"
#include "bench/suite.h"

namespace lightwell::bench {
namespace {

// The lights suite times in microseconds and keeps its own percentiles: its entries as rows.
Row row_from_json(const std::string& setting, const std::string& name, const nlohmann::ordered_json& entry) {
  Row row{setting, name, {std::numeric_limits<double>::quiet_NaN(), 0, 0, 0}, {}};
  for (const auto& [key, value] : entry.items()) {
    if (key == "p50_us")
      row.timing.p50_ms = value.get<double>() / 1000;
    else if (key == "p99_us")
      row.timing.p99_ms = value.get<double>() / 1000;
    else if (value.is_number())
      row.values.emplace_back(key, value.get<double>());
  }
  return row;
}

std::vector<Row> lights_rows(const Options& options) {
  constexpr double kFramesASecond = 500;
  const int frames = static_cast<int>(std::max(20.0, kFramesASecond * options.seconds_per_case));
  const nlohmann::ordered_json json = lights_suite(frames);
  std::vector<Row> rows;
  for (const auto& stage : json.at("stages"))
    rows.push_back(row_from_json("300 lights, stages", stage.at("name").get<std::string>(), stage));
  for (const auto& entry : json.at("sampling"))
    rows.push_back(row_from_json(std::to_string(entry.at("lights").get<int>()) + " lights",
                                 entry.at("method").get<std::string>(), entry));
  for (Row& row : rows) row.timing.runs = static_cast<std::size_t>(frames);
  for (const auto& more : {error_rows, temporal_rows, flicker_rows, growth_rows, rate_rows})
    for (Row& row : more(options)) rows.push_back(std::move(row));
  return rows;
}

}  // namespace

const std::vector<Suite>& suites() {
  static const std::vector<Suite> all = {
      {"frame", frame_suite},
      {"lights", lights_rows, curve_figures},
      {"fit", fit_suite, fit_figures},
      {"field", field_suite, field_figures},
      {"luminaire", luminaire_suite, luminaire_figures},
      {"lens", lens_suite},
      {"response", response_suite},
      {"sync", sync_suite},
      {"render", render_suite, render_figures},
      // Hundreds of rows: the lights suite has their plot, as means.
      {"coherence", coherence_suite, [](const std::vector<Row>&) { return std::vector<Figure>(); }},
  };
  return all;
}

}  // namespace lightwell::bench
