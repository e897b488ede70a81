// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "bench/chart.h"
#include "bench/render_suite.h"

namespace lightwell::bench {
namespace {

// One line a name, of the rows of a setting that have both values.
std::vector<Line> lines_of(const std::vector<Row>& rows, const std::string& setting, const std::string& x,
                           const std::string& y) {
  std::vector<Line> lines;
  for (const Row& row : rows) {
    if (row.setting != setting) continue;
    auto line = std::find_if(lines.begin(), lines.end(), [&](const Line& l) { return l.name == row.name; });
    if (line == lines.end()) line = lines.insert(lines.end(), Line{row.name, {}, false});
    line->points.emplace_back(value_of(row, x), value_of(row, y));
  }
  for (Line& line : lines) line.points_only = line.points.size() == 1;
  return lines;
}

Chart chart_of(const std::vector<Row>& rows, const std::string& title, const std::string& setting,
               const std::string& x, const std::string& x_label, const std::string& y,
               const std::string& y_label) {
  return {title, x_label, y_label, true, true, lines_of(rows, setting, x, y), {}};
}

}  // namespace

std::vector<Figure> render_figures(const std::vector<Row>& rows) {
  const std::string cpu = "processor time a frame, ms, median";
  const std::string size =
      std::to_string(pictures::kPictureWidth) + " x " + std::to_string(pictures::kPictureHeight);
  std::vector<Chart> rmse, flip;
  for (const pictures::JudgedScene& scene : pictures::judged_scenes()) {
    const std::string name(scene.name);
    rmse.push_back(chart_of(rows, name, "picture, " + name, "cpu_ms", cpu, "relative_rmse", "relative RMSE"));
    flip.push_back(chart_of(rows, name, "picture, " + name, "cpu_ms", cpu, "flip", "FLIP"));
  }
  const std::string caption = "lightwell bench --suite render: software OpenGL, " + size +
                              ", a light that turns; along a line lights (samples) double or quadruple";
  return {{"render-error", to_svg(rmse, caption)},
          {"render-flip", to_svg(flip, caption)},
          {"render-growth",
           to_svg({chart_of(rows, "Against lights", "growth, lights", "lights", "lights", "cpu_ms", cpu),
                   chart_of(rows, "Against triangles", "growth, triangles", "triangles", "triangles",
                            "cpu_ms", cpu),
                   chart_of(rows, "Against pixels", "growth, pixels", "pixels", "pixels", "cpu_ms", cpu),
                   chart_of(rows, "Preparing a scene", "growth, triangles", "triangles", "triangles",
                            "setup_ms", "ms, once")},
                  "lightwell bench --suite render: software OpenGL, balls on a ground under a sun, all maps "
                  "drawn anew")}};
}

}  // namespace lightwell::bench
