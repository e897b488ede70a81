// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/report/svg_plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace lightwell::calibration {
namespace {

constexpr double kLeft = 62, kRight = 14, kTop = 12, kBottom = 46;
constexpr double kPi = 3.14159265358979323846;

double part(const Axis& axis, double value) {
  if (axis.logarithmic)
    return (std::log(value) - std::log(axis.low)) / (std::log(axis.high) - std::log(axis.low));
  return (value - axis.low) / (axis.high - axis.low);
}

// Limits between which steps are numbers: in order, not nearly one, far from the ends of what a double holds.
Axis drawable(Axis axis) {
  constexpr double kLargest = 1e300;
  const double least = axis.logarithmic ? 1 / kLargest : -kLargest;
  axis.low = axis.low >= least ? std::min(axis.low, kLargest) : least;  // NaN too
  axis.high = axis.high <= kLargest ? std::max(axis.high, least) : kLargest;
  const double size = std::max(std::abs(axis.low), std::abs(axis.high));
  if (axis.high - axis.low > std::max(1e-9 * size, 1e-300)) return axis;
  axis.high = axis.logarithmic ? 10 * axis.low : axis.low + std::max(1.0, std::abs(axis.low));
  return axis;
}

// 1, 2 or 5 times a power of ten, some six of them; of a logarithmic axis the powers of ten.
std::vector<double> ticks(const Axis& axis) {
  std::vector<double> out;
  if (axis.logarithmic) {
    const int first = static_cast<int>(std::ceil(std::log10(axis.low) - 1e-9));
    const int last = static_cast<int>(std::floor(std::log10(axis.high) + 1e-9));
    const int step = std::max(1, (last - first) / 9);
    for (int e = first; e <= last; e += step) out.push_back(std::pow(10, e));
    return out;
  }
  const double raw = (axis.high - axis.low) / 6;
  const double power = std::pow(10, std::floor(std::log10(raw)));
  const double step = power * (raw / power < 2 ? 2 : raw / power < 5 ? 5 : 10);
  constexpr int kMost = 20;
  const double first = std::ceil(axis.low / step - 1e-9);
  for (int i = 0; i < kMost; ++i)
    if (const double v = (first + i) * step; v <= axis.high + 1e-9 * step)
      out.push_back(std::abs(v) < 1e-9 * step ? 0 : v);
  return out;
}

std::string number(double value) {
  return formatted("%.2f", value);
}

std::string text(double x, double y, const char* anchor, std::string_view words, const char* more = "") {
  return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor + "\"" + more + ">" +
         escaped(words) + "</text>";
}

}  // namespace

std::string escaped(std::string_view words) {
  std::string out;
  for (const char c : words) {
    if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '&')
      out += "&amp;";
    else if (c == '"')
      out += "&quot;";
    else if (static_cast<unsigned char>(c) < ' ')
      out += ' ';
    else
      out += c;
  }
  return out;
}

std::string formatted(const char* format, double value) {
  char out[64];
  std::snprintf(out, sizeof out, format, value);
  return out;
}

std::string plain_number(double value) {
  if (!std::isfinite(value)) return formatted("%g", value);
  const double size = std::abs(value);
  if (size == 0 || (size >= 1e-3 && size < 99950)) {
    // Three significant digits, none of them an exponent.
    const int digits = size == 0 ? 0 : std::clamp(2 - static_cast<int>(std::floor(std::log10(size))), 0, 5);
    char out[64];
    std::snprintf(out, sizeof out, "%.*f", digits, value);
    std::string text = out;
    if (text.find('.') != std::string::npos) {
      text.erase(text.find_last_not_of('0') + 1);
      if (text.back() == '.') text.pop_back();
    }
    return text;
  }
  int power = static_cast<int>(std::floor(std::log10(size * 1.0005)));
  const char* digit[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string raised = power < 0 ? "⁻" : "";
  for (const char c : std::to_string(std::abs(power))) raised += digit[c - '0'];
  const std::string mantissa = formatted("%.3g", value / std::pow(10, power));
  return (mantissa == "1" ? "" : mantissa + "·") + "10" + raised;
}

SvgPlot::SvgPlot(int width, int height, Axis x, Axis y)
    : width_(width), height_(height), x_(drawable(std::move(x))), y_(drawable(std::move(y))) {
  grid();
}

double SvgPlot::at_x(double x) const {
  return kLeft + part(x_, x) * (width_ - kLeft - kRight);
}
double SvgPlot::at_y(double y) const {
  return height_ - kBottom - part(y_, y) * (height_ - kTop - kBottom);
}

void SvgPlot::grid() {
  const double right = width_ - kRight, bottom = height_ - kBottom;
  for (const double v : ticks(x_)) {
    const double x = at_x(v);
    frame_ += "<line class=\"grid\" x1=\"" + number(x) + "\" y1=\"" + number(kTop) + "\" x2=\"" + number(x) +
              "\" y2=\"" + number(bottom) + "\"/>" + text(x, bottom + 16, "middle", plain_number(v));
  }
  for (const double v : ticks(y_)) {
    const double y = at_y(v);
    frame_ += "<line class=\"grid\" x1=\"" + number(kLeft) + "\" y1=\"" + number(y) + "\" x2=\"" +
              number(right) + "\" y2=\"" + number(y) + "\"/>" +
              text(kLeft - 6, y + 4, "end", formatted("%g", v));
  }
  frame_ += text((kLeft + right) / 2, height_ - 8, "middle", x_.label);
  const double middle = (kTop + bottom) / 2;
  frame_ +=
      text(14, middle, "middle", y_.label, (" transform=\"rotate(-90 14 " + number(middle) + ")\"").c_str());
}

std::string SvgPlot::path(const Points& points) const {
  std::string out;
  for (const auto& [x, y] : points)
    if (const double px = at_x(x), py = at_y(y); std::isfinite(px) && std::isfinite(py))
      out += (out.empty() ? "M" : "L") + number(std::clamp(px, -1e4, 1e4)) + " " +
             number(std::clamp(py, -1e4, 1e4));
  return out;
}

void SvgPlot::line(const Points& points, std::string_view css) {
  body_ += "<path fill=\"none\" class=\"" + std::string(css) + "\" d=\"" + path(points) + "\"/>";
}

void SvgPlot::band(const Points& low, const Points& high, std::string_view css) {
  Points around = low;
  around.insert(around.end(), high.rbegin(), high.rend());
  body_ += "<path class=\"" + std::string(css) + "\" d=\"" + path(around) + "Z\"/>";
}

void SvgPlot::dot(double x, double y, std::string_view css, std::string_view tip) {
  const double px = at_x(x), py = at_y(y);
  if (!std::isfinite(px) || !std::isfinite(py)) return;
  body_ += "<circle class=\"" + std::string(css) + "\" cx=\"" + number(px) + "\" cy=\"" + number(py) +
           "\" r=\"4\"><title>" + escaped(tip) + "</title></circle>";
}

void SvgPlot::bar_x(double low, double high, double y, std::string_view css) {
  line({{low, y}, {high, y}}, css);
}
void SvgPlot::bar_y(double x, double low, double high, std::string_view css) {
  line({{x, low}, {x, high}}, css);
}

std::string SvgPlot::svg() const {
  const std::string size = std::to_string(width_) + " " + std::to_string(height_);
  return "<svg viewBox=\"0 0 " + size + "\" width=\"" + std::to_string(width_) + "\">" + frame_ +
         "<svg x=\"" + number(kLeft) + "\" y=\"" + number(kTop) + "\" width=\"" +
         number(width_ - kLeft - kRight) + "\" height=\"" + number(height_ - kTop - kBottom) +
         "\" viewBox=\"" + number(kLeft) + " " + number(kTop) + " " + number(width_ - kLeft - kRight) + " " +
         number(height_ - kTop - kBottom) + "\">" + body_ + "</svg></svg>";
}

std::string polar_cells(int size, const std::vector<std::vector<std::string>>& fill,
                        const std::vector<std::string>& rim) {
  const double centre = size / 2.0, most = centre - 4;
  const auto rings = static_cast<double>(fill.size());
  std::string out = "<svg viewBox=\"0 0 " + std::to_string(size) + " " + std::to_string(size) +
                    "\" width=\"" + std::to_string(size) + "\">";
  for (std::size_t r = 0; r < fill.size(); ++r) {
    const double inner = most * static_cast<double>(r) / rings,
                 outer = most * static_cast<double>(r + 1) / rings;
    const auto sectors = static_cast<double>(fill[r].size());
    for (std::size_t s = 0; s < fill[r].size(); ++s) {
      const double a = 2 * kPi * static_cast<double>(s) / sectors,
                   b = 2 * kPi * static_cast<double>(s + 1) / sectors;
      const auto at = [&](double radius, double angle) {
        return number(centre + radius * std::sin(angle)) + " " + number(centre - radius * std::cos(angle));
      };
      const auto arc = [](double radius, int sweep) {
        return "A" + number(radius) + " " + number(radius) + " 0 0 " + std::to_string(sweep) + " ";
      };
      out += "<path fill=\"" + fill[r][s] + "\" stroke=\"#fff\" stroke-width=\".5\" d=\"M" + at(inner, a) +
             "L" + at(outer, a) + arc(outer, 1) + at(outer, b) + "L" + at(inner, b) + arc(inner, 0) +
             at(inner, a) + "Z\"/>";
    }
  }
  for (std::size_t r = 0; r < rim.size() && r < fill.size(); ++r)
    if (!rim[r].empty())
      out += text(centre + 2, centre - most * static_cast<double>(r + 1) / rings + 11, "start", rim[r],
                  " class=\"halo\"");
  return out + "</svg>";
}

std::string shade(double value) {
  const double v = value > 0 ? std::min(value, 1.0) : 0;  // NaN too
  const auto mix = [v](int pale, int dark) {
    return static_cast<int>(std::lround(pale + (dark - pale) * v));
  };
  char out[16];
  std::snprintf(out, sizeof out, "#%02x%02x%02x", static_cast<unsigned>(mix(0xe8, 0x08)),
                static_cast<unsigned>(mix(0xf1, 0x30)), static_cast<unsigned>(mix(0xfa, 0x6b)));
  return out;
}

}  // namespace lightwell::calibration
