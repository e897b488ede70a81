// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "bench/xml_text.h"

namespace lightwell::bench {
namespace {

constexpr double kWidth = 460;
constexpr double kHeight = 330;
constexpr double kLeft = 66, kRight = 14, kTop = 34, kBottom = 48;

// Distinct also in grey by their marks; after Paul Tol's bright and muted schemes.
constexpr std::array kColours = {"#4477aa", "#ee6677", "#228833", "#aa3377", "#ccbb44", "#66ccee", "#882255",
                                 "#117733", "#dd7722", "#332288", "#999933", "#777777", "#44aa99", "#bb5566"};

std::string text_of(double v) {
  char text[32];
  std::snprintf(text, sizeof text, v >= 1e4 && v < 1e8 ? "%.0f" : "%.4g", v);
  return text;
}

std::string at(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", v);
  return text;
}

struct Axis {
  bool logarithmic = false;
  double low = 0, high = 1;  // in the axis' own measure, a logarithm where it is one
  [[nodiscard]] double measure(double v) const { return logarithmic ? std::log10(v) : v; }
  [[nodiscard]] bool holds(double v) const { return std::isfinite(v) && (!logarithmic || v > 0); }
  [[nodiscard]] double share(double v) const { return (measure(v) - low) / (high - low); }
  // Where lines and numbers stand: decades with 2 and 5 where there are few, else round steps.
  [[nodiscard]] std::vector<double> ticks() const {
    std::vector<double> list;
    if (logarithmic) {
      const std::vector<double> within =
          high - low < 2.2 ? std::vector<double>{1, 2, 5} : std::vector<double>{1};
      for (int decade = static_cast<int>(std::floor(low)); decade <= static_cast<int>(std::ceil(high));
           ++decade)
        for (const double digit : within) {
          const double v = digit * std::pow(10.0, decade);
          if (measure(v) >= low - 1e-9 && measure(v) <= high + 1e-9) list.push_back(v);
        }
      return list;
    }
    const double rough = (high - low) / 5;
    const double decade = std::pow(10.0, std::floor(std::log10(rough)));
    const double step = decade * (rough / decade < 1.5 ? 1 : rough / decade < 3.5 ? 2 : 5);
    for (double v = std::ceil(low / step) * step; v <= high + 1e-9 * step; v += step)
      list.push_back(std::abs(v) < step * 1e-9 ? 0 : v);
    return list;
  }
};

Axis axis_over(const Chart& chart, bool horizontal) {
  Axis axis;
  axis.logarithmic = horizontal ? chart.log_x : chart.log_y;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  Axis other;
  other.logarithmic = horizontal ? chart.log_y : chart.log_x;
  for (const Line& line : chart.lines)
    for (const auto& [x, y] : line.points) {
      const double v = horizontal ? x : y;
      if (!axis.holds(v) || !other.holds(horizontal ? y : x)) continue;
      low = std::min(low, axis.measure(v));
      high = std::max(high, axis.measure(v));
    }
  if (!(high >= low)) low = 0, high = 1;  // nothing to show
  if (!axis.logarithmic) low = std::min(low, 0.0);
  const double margin = high > low ? 0.05 * (high - low) : 0.5;
  axis.low = axis.logarithmic || low < 0 ? low - margin : low;
  axis.high = high + margin;
  return axis;
}

std::string mark(std::size_t kind, double x, double y, const std::string& colour) {
  const auto polygon = [&](std::initializer_list<std::pair<double, double>> corners) {
    std::string points;
    for (const auto& [dx, dy] : corners) points += at(x + dx) + "," + at(y + dy) + " ";
    return "<polygon points='" + points + "' fill='" + colour + "'/>";
  };
  switch (kind % 4) {
    case 0:
      return "<circle cx='" + at(x) + "' cy='" + at(y) + "' r='3.2' fill='" + colour + "'/>";
    case 1:
      return polygon({{-3, -3}, {3, -3}, {3, 3}, {-3, 3}});
    case 2:
      return polygon({{0, -4}, {4, 3}, {-4, 3}});
    default:
      return polygon({{0, -4.2}, {4.2, 0}, {0, 4.2}, {-4.2, 0}});
  }
}

std::string frame_of(const Chart& chart, const Axis& x_axis, const Axis& y_axis) {
  const double width = kWidth - kLeft - kRight;
  const double height = kHeight - kTop - kBottom;
  std::string svg = "<text x='" + at(kLeft) + "' y='20' font-size='14' font-weight='bold'>" +
                    escaped(chart.title) + "</text>\n";
  for (const double v : chart.x_ticks.empty() ? x_axis.ticks() : chart.x_ticks) {
    if (!(x_axis.share(v) >= 0 && x_axis.share(v) <= 1)) continue;
    const std::string x = at(kLeft + width * x_axis.share(v));
    svg += "<line x1='" + x + "' x2='" + x + "' y1='" + at(kTop) + "' y2='" + at(kTop + height) +
           "' stroke='#ddd'/><text x='" + x + "' y='" + at(kTop + height + 16) + "' text-anchor='middle'>" +
           text_of(v) + "</text>\n";
  }
  for (const double v : y_axis.ticks()) {
    const std::string y = at(kTop + height * (1 - y_axis.share(v)));
    svg += "<line y1='" + y + "' y2='" + y + "' x1='" + at(kLeft) + "' x2='" + at(kLeft + width) +
           "' stroke='#ddd'/><text y='" + y + "' x='" + at(kLeft - 6) +
           "' text-anchor='end' dominant-baseline='middle'>" + text_of(v) + "</text>\n";
  }
  svg += "<rect x='" + at(kLeft) + "' y='" + at(kTop) + "' width='" + at(width) + "' height='" + at(height) +
         "' fill='none' stroke='#333'/>\n<text x='" + at(kLeft + width / 2) + "' y='" + at(kHeight - 10) +
         "' text-anchor='middle'>" + escaped(chart.x_label) + "</text>\n<text transform='translate(14," +
         at(kTop + height / 2) + ") rotate(-90)' text-anchor='middle'>" + escaped(chart.y_label) +
         "</text>\n";
  return svg;
}

std::string chart_svg(const Chart& chart, const std::vector<std::string>& names) {
  const Axis x_axis = axis_over(chart, true);
  const Axis y_axis = axis_over(chart, false);
  std::string svg = frame_of(chart, x_axis, y_axis);
  for (const Line& line : chart.lines) {
    const auto kind =
        static_cast<std::size_t>(std::find(names.begin(), names.end(), line.name) - names.begin());
    const std::string colour = kColours[kind % kColours.size()];
    std::string path, marks;
    for (const auto& [x, y] : line.points) {
      if (!x_axis.holds(x) || !y_axis.holds(y)) continue;
      const double px = kLeft + (kWidth - kLeft - kRight) * x_axis.share(x);
      const double py = kTop + (kHeight - kTop - kBottom) * (1 - y_axis.share(y));
      path += at(px) + "," + at(py) + " ";
      marks += mark(kind, px, py, colour);
    }
    if (!line.points_only)
      svg += "<polyline points='" + path + "' fill='none' stroke='" + colour +
             (line.name == "best" ? "' stroke-width='3'/>" : "' stroke-width='1.6'/>");
    svg += marks + "\n";
  }
  return svg;
}

}  // namespace

std::string to_svg(const std::vector<Chart>& charts, const std::string& caption) {
  std::vector<std::string> names;
  for (const Chart& chart : charts)
    for (const Line& line : chart.lines)
      if (std::find(names.begin(), names.end(), line.name) == names.end()) names.push_back(line.name);
  const std::size_t columns = std::min<std::size_t>(2, std::max<std::size_t>(1, charts.size()));
  const std::size_t rows = (charts.size() + columns - 1) / columns;
  const double width = kWidth * static_cast<double>(columns);
  std::string body;
  for (std::size_t i = 0; i < charts.size(); ++i)
    body += "<g transform='translate(" + at(kWidth * static_cast<double>(i % columns)) + "," +
            at(kHeight * static_cast<double>(i / columns)) + ")'>\n" + chart_svg(charts[i], names) + "</g>\n";
  double x = 20;
  double y = kHeight * static_cast<double>(rows) + 16;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double entry = 30 + 7.0 * static_cast<double>(names[i].size());
    if (x + entry > width) {
      x = 20;
      y += 20;
    }
    const std::string colour = kColours[i % kColours.size()];
    body += "<line x1='" + at(x) + "' x2='" + at(x + 18) + "' y1='" + at(y) + "' y2='" + at(y) +
            "' stroke='" + colour + "' stroke-width='2'/>" + mark(i, x + 9, y, colour) + "<text x='" +
            at(x + 23) + "' y='" + at(y + 4) + "'>" + escaped(names[i]) + "</text>\n";
    x += entry + 10;
  }
  y += 26;
  body += "<text x='20' y='" + at(y) + "' fill='#555'>" + escaped(caption) + "</text>\n";
  return "<svg xmlns='http://www.w3.org/2000/svg' width='" + at(width) + "' height='" + at(y + 14) +
         "' font-family='sans-serif' font-size='12'>\n<rect width='100%' height='100%' fill='white'/>\n" +
         body + "</svg>\n";
}

}  // namespace lightwell::bench
