// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace lightwell::bench {

// A line of a chart, or points on their own. Colours and marks go by the name, the same in all charts of a picture.
struct Line {
  std::string name;
  std::vector<std::pair<double, double>> points;
  bool points_only = false;
};

// One plot. Logarithmic axes leave out what is not above 0; points that are no number are left out.
struct Chart {
  std::string title;
  std::string x_label, y_label;  // with their units
  bool log_x = true, log_y = true;
  std::vector<Line> lines;
  std::vector<double> x_ticks = {};  // empty: decades, or round steps
};

// Charts beside each other, in rows of two, with one legend below and a line of text under all.
std::string to_svg(const std::vector<Chart>& charts, const std::string& caption);

}  // namespace lightwell::bench
