// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/false_colour.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace lightwell::render {
namespace {

constexpr double kLowestDecade = -2;
constexpr double kHighestDecade = 6;
constexpr double kStops = 8;

// One a decade of cd/m², from 10⁻² to 10⁶.
constexpr Rgb8 kDecades[] = {{40, 0, 70},   {0, 0, 200},   {0, 140, 255}, {0, 200, 160},  {0, 170, 0},
                             {210, 210, 0}, {255, 130, 0}, {255, 0, 0},   {255, 180, 220}};
// One a stop, from −8 to 8.
constexpr Rgb8 kPerStop[] = {{25, 0, 50},    {60, 0, 110},   {90, 20, 170}, {50, 40, 220},   {20, 90, 240},
                             {0, 140, 230},  {0, 170, 180},  {0, 150, 110}, {119, 119, 119}, {120, 170, 60},
                             {190, 200, 40}, {240, 220, 0},  {250, 180, 0}, {250, 130, 0},   {250, 70, 0},
                             {225, 0, 0},    {255, 120, 200}};

// Digits and a minus sign, five rows of three bits.
constexpr std::array<std::array<std::uint8_t, 5>, 11> kGlyphs = {{{7, 5, 5, 5, 7},
                                                                  {2, 6, 2, 2, 7},
                                                                  {7, 1, 7, 4, 7},
                                                                  {7, 1, 7, 1, 7},
                                                                  {5, 5, 7, 1, 1},
                                                                  {7, 4, 7, 1, 7},
                                                                  {7, 4, 7, 5, 7},
                                                                  {7, 1, 2, 2, 2},
                                                                  {7, 5, 7, 5, 7},
                                                                  {7, 5, 7, 1, 7},
                                                                  {0, 0, 7, 0, 0}}};

class Canvas {
 public:
  explicit Canvas(Legend& legend) : legend_(legend) {
    legend_.rgba.assign(static_cast<std::size_t>(legend.width * legend.height) * 4, 0);
    for (std::size_t i = 3; i < legend_.rgba.size(); i += 4) legend_.rgba[i] = 255;
  }
  void fill(int x, int y, int width, int height, const Rgb8& colour) {
    for (int row = std::max(y, 0); row < std::min(y + height, legend_.height); ++row)
      for (int column = std::max(x, 0); column < std::min(x + width, legend_.width); ++column)
        std::copy(colour.begin(), colour.end(),
                  legend_.rgba.begin() + 4 * (static_cast<std::ptrdiff_t>(row) * legend_.width + column));
  }
  // pixel: side of a glyph's dot.
  void write(const std::string& text, int x, int y, int pixel) {
    for (const char letter : text) {
      const auto& rows = kGlyphs[letter == '-' ? 10 : static_cast<std::size_t>(letter - '0')];
      for (int row = 0; row < 5; ++row)
        for (int column = 0; column < 3; ++column)
          if ((rows[static_cast<std::size_t>(row)] >> (2 - column) & 1) != 0)
            fill(x + column * pixel, y + row * pixel, pixel, pixel, {255, 255, 255});
      x += 4 * pixel;
    }
  }

 private:
  Legend& legend_;
};

}  // namespace

double FalseColourScale::low() const {
  return kind == FalseColour::stops ? -kStops - 0.5 : kLowestDecade * std::log2(10.0);
}
double FalseColourScale::high() const {
  return kind == FalseColour::stops ? kStops + 0.5 : kHighestDecade * std::log2(10.0);
}

Rgb8 FalseColourScale::colour(double value) const {
  if (!(value >= low())) return {0, 0, 0};
  if (value > high()) return {255, 255, 255};
  if (kind == FalseColour::stops) {
    const auto stop = static_cast<std::size_t>(std::clamp(std::lround(value + kStops), 0L, 16L));
    return kPerStop[stop];
  }
  const double place = std::clamp(value / std::log2(10.0) - kLowestDecade, 0.0, 7.999999);
  const auto first = static_cast<std::size_t>(place);
  Rgb8 colour;
  for (std::size_t c = 0; c < 3; ++c)
    colour[c] = static_cast<std::uint8_t>(std::lround(
        std::lerp(kDecades[first][c], kDecades[first + 1][c], place - static_cast<double>(first))));
  return colour;
}

std::vector<Rgb8> FalseColourScale::table(int count) const {
  std::vector<Rgb8> colours;
  for (int i = 0; i < count; ++i) colours.push_back(colour(low() + (high() - low()) * (i + 0.5) / count));
  return colours;
}

Legend make_legend(const FalseColourScale& scale, int picture_height) {
  // 17 stops or 9 decades, each with five dots of a digit and two of space.
  const bool stops = scale.kind == FalseColour::stops;
  const int marks = stops ? 17 : 9;
  const int pixel = std::min(3, picture_height / (marks * 7 + 4));
  if (pixel < 1) return {};
  const int step = 7 * pixel;
  const int bar = 6 * pixel;
  // The longest number is 1000000 of seven digits, the lowest decades are fractions: written as powers, 10 to the n.
  Legend legend{bar + pixel + (stops ? 2 : 2) * 4 * pixel + pixel, marks * step + 2 * pixel, {}};
  Canvas canvas(legend);
  const int top = pixel + step / 2;             // of the highest mark's middle
  const int bottom = top + (marks - 1) * step;  // of the lowest mark's middle
  const double span = stops ? 16 : scale.high() - scale.low();
  const double lowest = stops ? -kStops : scale.low();
  for (int y = pixel; y < legend.height - pixel; ++y) {
    const double value = lowest + span * (bottom - y) / (bottom - top);
    canvas.fill(0, y, bar, 1, scale.colour(std::clamp(value, scale.low(), scale.high())));
  }
  for (int i = 0; i < marks; ++i) {
    const int number = stops ? static_cast<int>(kStops) - i : static_cast<int>(kHighestDecade) - i;
    const std::string text = std::to_string(number);
    const int x = legend.width - static_cast<int>(text.size()) * 4 * pixel;
    canvas.write(text, x, top + i * step - 2 * pixel - pixel / 2, pixel);
  }
  return legend;
}

}  // namespace lightwell::render
