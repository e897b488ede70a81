// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/lamps_and_dust.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lighting/median.h"

namespace lightwell::calibration {
namespace {

constexpr double kMostOfOne = 6;        // spreads that one pixel counts for
constexpr double kPlace = 4;            // spreads of a square's mean that make a place
constexpr double kAround = 1;           // that belong to it: five times the scatter of a square's mean
constexpr double kLeastSpread = 0.5;    // codes: an even scene is no evener than that
constexpr double kMostOfLine = 4;       // spreads of the lines' medians that a line's may be off
constexpr int kReach = 2;               // of a square: five by five
constexpr double kFewestInSquare = 12;  // at the border of the field
constexpr int kRounds = 3;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();  // no sample here

double spread(std::vector<double> values) {
  for (double& v : values) v = std::abs(v);
  return 1.4826 * median(std::move(values));
}

struct Plane {
  int width = 0, height = 0;
  std::vector<double> at;  // [height][width]

  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
  [[nodiscard]] bool holds(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
};

// Takes the median of each column (or row) out. A lamp may cover most of a short line: no line may be off by more than
// the others are.
void take_lines_out(Plane& plane, bool columns) {
  const int lines = columns ? plane.width : plane.height, along = columns ? plane.height : plane.width;
  std::vector<double> offsets(static_cast<std::size_t>(lines), 0), present;
  const auto pixel = [&](int line, int i) -> double& {
    return plane.at[columns ? plane.index(line, i) : plane.index(i, line)];
  };
  for (int line = 0; line < lines; ++line) {
    std::vector<double> values;
    for (int i = 0; i < along; ++i)
      if (!std::isnan(pixel(line, i))) values.push_back(pixel(line, i));
    if (values.empty()) continue;
    offsets[static_cast<std::size_t>(line)] = median(std::move(values));
    present.push_back(offsets[static_cast<std::size_t>(line)]);
  }
  const double most = kMostOfLine * spread(std::move(present));
  for (int line = 0; line < lines; ++line)
    for (int i = 0; i < along; ++i)
      pixel(line, i) -= std::clamp(offsets[static_cast<std::size_t>(line)], -most, most);
}

// Mean over the square about each pixel that has a sample, in spreads.
Plane means_over_squares(const Plane& plane, double one) {
  Plane out{plane.width, plane.height, std::vector<double>(plane.at.size(), 0)};
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x) {
      if (std::isnan(plane.at[plane.index(x, y)])) continue;
      double sum = 0, count = 0;
      for (int v = std::max(0, y - kReach); v <= std::min(plane.height - 1, y + kReach); ++v)
        for (int u = std::max(0, x - kReach); u <= std::min(plane.width - 1, x + kReach); ++u)
          if (const double r = plane.at[plane.index(u, v)]; !std::isnan(r))
            sum += std::clamp(r / one, -kMostOfOne, kMostOfOne), ++count;
      out.at[out.index(x, y)] = sum / std::max(count, kFewestInSquare);
    }
  return out;
}

// Whether each pixel lies in such a place.
std::vector<char> places(Plane plane) {
  take_lines_out(plane, true);
  take_lines_out(plane, false);
  std::vector<double> present;
  for (const double r : plane.at)
    if (!std::isnan(r)) present.push_back(r);
  const Plane mean = means_over_squares(plane, std::max(spread(std::move(present)), kLeastSpread));
  std::vector<char> out(plane.at.size(), 0);
  std::vector<std::pair<int, int>> open;
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x)
      if (std::abs(mean.at[mean.index(x, y)]) > kPlace) out[mean.index(x, y)] = 1, open.emplace_back(x, y);
  while (!open.empty()) {  // its surroundings, on the same side
    const auto [x, y] = open.back();
    open.pop_back();
    const double here = mean.at[mean.index(x, y)];
    for (const auto& [u, v] : {std::pair{x - 1, y}, {x + 1, y}, {x, y - 1}, {x, y + 1}}) {
      if (!plane.holds(u, v) || out[plane.index(u, v)] != 0) continue;
      const double there = mean.at[mean.index(u, v)];
      if (!(there * here > 0 && std::abs(there) > kAround)) continue;
      out[plane.index(u, v)] = 1;
      open.emplace_back(u, v);
    }
  }
  std::vector<char> wide = out;
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x) {
      if (out[plane.index(x, y)] == 0) continue;
      for (int v = y - kReach; v <= y + kReach; ++v)
        for (int u = x - kReach; u <= x + kReach; ++u)
          if (plane.holds(u, v)) wide[plane.index(u, v)] = 1;
    }
  return wide;
}

// Of a mosaic, each of the four colours by itself as well.
std::vector<char> places_of_take(const Plane& plane, bool mosaic) {
  std::vector<char> out = places(plane);
  if (!mosaic) return out;
  for (int first = 0; first < 4; ++first) {
    const int left = first % 2, top = first / 2;
    Plane part{(plane.width - left + 1) / 2, (plane.height - top + 1) / 2, {}};
    for (int y = 0; y < part.height; ++y)
      for (int x = 0; x < part.width; ++x)
        part.at.push_back(plane.at[plane.index(2 * x + left, 2 * y + top)]);
    const std::vector<char> found = places(part);
    for (int y = 0; y < part.height; ++y)
      for (int x = 0; x < part.width; ++x)
        if (found[part.index(x, y)] != 0)  // two by two, the colours of one place
          for (int v = 2 * y; v <= 2 * y + 1; ++v)
            for (int u = 2 * x; u <= 2 * x + 1; ++u)
              if (plane.holds(u, v)) out[plane.index(u, v)] = 1;
  }
  return out;
}

// Whether each sample lies in such a place of its take.
std::vector<char> masked_samples(const std::vector<EvenSample>& samples, const VignettingFit& fit,
                                 const Response& response, const FrameFormat& format) {
  std::vector<char> out(samples.size(), 0);
  const auto pixels = static_cast<std::size_t>(format.width) * static_cast<std::size_t>(format.height);
  for (int take = 0; take < fit.takes; ++take) {
    Plane residual{format.width, format.height, std::vector<double>(pixels, kNone)};
    for (const EvenSample& s : samples)
      if (s.take == take) residual.at[s.index] = fit.residual(s, response);
    const std::vector<char> found = places_of_take(residual, is_bayer(format.pixel_format));
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (samples[i].take == take) out[i] = found[samples[i].index];
  }
  return out;
}

}  // namespace

CleanFit fit_without_lamps_and_dust(const std::vector<EvenSample>& samples, const Response& response,
                                    const FrameFormat& format, int levels, int takes) {
  CleanFit out;
  out.fit = fit_vignetting(samples, response, levels, takes);
  out.tilt_before = out.fit.tilt();
  out.samples = samples;
  std::vector<char> masked(samples.size(), 0);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<char> now = masked_samples(samples, out.fit, response, format);
    if (now == masked) break;
    masked = std::move(now);
    out.samples.clear();
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (masked[i] == 0) out.samples.push_back(samples[i]);
    if (2 * out.samples.size() < samples.size()) break;  // nothing even is left to fit to
    out.fit = fit_vignetting(out.samples, response, levels, takes);
  }
  out.masked_in.assign(static_cast<std::size_t>(takes), 0);
  out.samples_in = out.masked_in;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    ++out.samples_in[static_cast<std::size_t>(samples[i].take)];
    if (masked[i] == 0) continue;
    ++out.masked_in[static_cast<std::size_t>(samples[i].take)];
    out.masked.push_back(samples[i].index);
  }
  std::sort(out.masked.begin(), out.masked.end());
  out.masked.erase(std::unique(out.masked.begin(), out.masked.end()), out.masked.end());
  return out;
}

void fill_masked(const std::vector<std::size_t>& masked, const std::vector<char>& told, int width,
                 std::vector<float>& offset_codes) {
  constexpr std::size_t kFewest = 8;
  const auto step = static_cast<std::size_t>(width);
  for (const std::size_t pixel : masked) {
    if (told[pixel] != 0) continue;
    std::vector<double> column;
    for (std::size_t i = pixel % step; i < told.size(); i += step)
      if (told[i] != 0) column.push_back(static_cast<double>(offset_codes[i]));
    offset_codes[pixel] = column.size() < kFewest ? 0.0f : static_cast<float>(median(std::move(column)));
  }
}

}  // namespace lightwell::calibration
