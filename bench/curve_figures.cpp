// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "bench/chart.h"
#include "bench/error_curves.h"

namespace lightwell::bench {
namespace {

double value_of(const Row& row, const std::string& key) {
  for (const auto& [name, value] : row.values)
    if (name == key) return value;
  return std::numeric_limits<double>::quiet_NaN();
}

using Measure = std::function<double(const Row&)>;
Measure value(const std::string& key) {
  return [key](const Row& row) { return value_of(row, key); };
}
Measure p50_ms() {
  return [](const Row& row) { return row.timing.p50_ms; };
}

// One line a name, of the rows of a setting.
std::vector<Line> lines_of(const std::vector<Row>& rows, const std::string& setting, const Measure& x,
                           const Measure& y, bool points_only = false) {
  std::vector<Line> lines;
  for (const Row& row : rows) {
    if (row.setting != setting) continue;
    auto line = std::find_if(lines.begin(), lines.end(), [&](const Line& l) { return l.name == row.name; });
    if (line == lines.end()) line = lines.insert(lines.end(), {row.name, {}, points_only});
    line->points.emplace_back(x(row), y(row));
  }
  return lines;
}

const std::vector<double> kLightTicks = {4, 8, 16, 32, 64, 128, 256, 512, 1024};

Figure error_figure(const std::vector<Row>& rows, double maps) {
  const std::string over = std::to_string(static_cast<int>(maps)) + " maps, 90 x 360 over the hemisphere";
  const std::string error = "relative RMSE, geometric mean";
  return {
      "lights-error",
      to_svg({{"Irradiance error against lights", "lights", error, true, true,
               lines_of(rows, "error", value("lights"), value("irradiance_rel_rmse")), kLightTicks},
              {"Shadow error against lights", "lights", error, true, true,
               lines_of(rows, "error", value("lights"), value("shadow_rel_rmse")), kLightTicks},
              {"Irradiance error against time", "time a frame, ms, median", error, true, true,
               lines_of(rows, "error", p50_ms(), value("irradiance_rel_rmse"))},
              {"Shadow error against time", "time a frame, ms, median", error, true, true,
               lines_of(rows, "error", p50_ms(), value("shadow_rel_rmse"))}},
             "lightwell bench --suite lights: " + over + "; along a line by time, lights double from 4 on")};
}

Figure latency_figure(const std::vector<Row>& rows) {
  const Measure latency = value("latency_frames");
  const std::string x = "latency of power, frames";
  return {"lights-excess-latency",
          to_svg({{"Restlessness beyond the light's own", x, "excess of the shadow image", false, false,
                   lines_of(rows, "temporal", latency, value("shadow_excess"), true)},
                  {"Shadow error, lag counted", x, "relative RMSE", false, false,
                   lines_of(rows, "temporal", latency, value("shadow_error"), true)},
                  {"Error of the change from frame to frame", x, "relative RMSE of the change", false, false,
                   lines_of(rows, "temporal", latency, value("shadow_change_error"), true)},
                  {"Mains flicker that is left", "latency of a switched lamp, frames",
                   "swing of total power, relative", false, false,
                   lines_of(rows, "flicker", latency, value("swing"), true)}},
                 "lightwell bench --suite lights: 64 lights, means over all moving lights")};
}

Figure growth_figure(const std::vector<Row>& rows) {
  return {"lights-growth", to_svg({{"Time against lights", "lights", "time a frame, ms, median", true, true,
                                    lines_of(rows, "growth, lights", value("lights"), p50_ms()), kLightTicks},
                                   {"Time against pixels, 64 lights",
                                    "pixels of the map",
                                    "time a frame, ms, median",
                                    true,
                                    true,
                                    lines_of(rows, "growth, pixels", value("pixels"), p50_ms()),
                                    {32400, 129600, 518400, 2073600}},
                                   {"Load against frame rate, 64 lights",
                                    "frames a second",
                                    "share of one core",
                                    true,
                                    true,
                                    lines_of(rows, "growth, rate", value("rate_hz"), value("share_of_core")),
                                    {15, 30, 60, 120, 240}},
                                   {"Shadow error against frame rate",
                                    "frames a second",
                                    "relative RMSE",
                                    true,
                                    true,
                                    lines_of(rows, "growth, rate", value("rate_hz"), value("shadow_error")),
                                    {15, 30, 60, 120, 240}}},
                                  "lightwell bench --suite lights: a painted sky with a sun, warm frames")};
}

}  // namespace

std::vector<Figure> curve_figures(const std::vector<Row>& rows) {
  std::vector<Row> bars;
  double maps = 0;
  for (const Row& row : rows) {
    const bool curve = row.setting == "error" || row.setting == "prefix" || row.setting == "temporal" ||
                       row.setting == "flicker" || row.setting.starts_with("growth");
    if (!curve) bars.push_back(row);
    if (row.setting == "error") maps = std::max(maps, value_of(row, "maps"));
  }
  return {{"lights", to_svg("lights", bars)},
          error_figure(rows, maps),
          latency_figure(rows),
          growth_figure(rows)};
}

}  // namespace lightwell::bench
