// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lightwell::calibration {

// Text for HTML and SVG: <, >, &, quotes and control characters made harmless.
std::string escaped(std::string_view text);
// Three digits as a person writes them: 0.11, 6300, 1.2·10⁵.
std::string plain_number(double value);
// printf for one number.
std::string formatted(const char* format, double value);

struct Axis {
  double low = 0, high = 1;
  bool logarithmic = false;  // low and high above 0
  std::string label;
};

// A picture with axes, grid and numbers; what is drawn is cut at the frame. Not finite points are left out.
class SvgPlot {
 public:
  SvgPlot(int width, int height, Axis x, Axis y);

  using Points = std::vector<std::pair<double, double>>;
  void line(const Points& points, std::string_view css);
  void band(const Points& low, const Points& high, std::string_view css);
  void dot(double x, double y, std::string_view css, std::string_view tip);
  void bar_x(double low, double high, double y, std::string_view css);
  void bar_y(double x, double low, double high, std::string_view css);
  [[nodiscard]] std::string svg() const;

 private:
  [[nodiscard]] double at_x(double x) const;
  [[nodiscard]] double at_y(double y) const;
  [[nodiscard]] std::string path(const Points& points) const;
  void grid();
  int width_, height_;
  Axis x_, y_;
  std::string frame_, body_;
};

// A disc of rings (0 at the centre) and sectors (0 at the top, clockwise), each cell of a colour.
// fill: [ring][sector] CSS colours; rim: labels of the rings' outer edges, empty: none.
std::string polar_cells(int size, const std::vector<std::vector<std::string>>& fill,
                        const std::vector<std::string>& rim);

// From pale to dark, 0 to 1.
std::string shade(double value);

}  // namespace lightwell::calibration
