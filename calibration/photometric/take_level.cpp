// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/take_level.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "lighting/median.h"

namespace lightwell::calibration {
namespace {

constexpr double kCoarsest = 0.05;  // one code, as a part of the luminance
constexpr std::size_t kFewestPixels = 100;

// A response without a toe has no code for darkness: then it is the smallest that is of use.
double dark_code(const Response& response) {
  const double code = response.code(0);
  return std::isfinite(code) ? code : response.black_code;
}

double darkest_lit_code(const Response& response) {
  const double dark = dark_code(response);
  return dark + kDarkPart * (response.clip_code - dark);
}

// Median codes of the colours that are there, the darkest first.
std::vector<double> levels(const MeanFrame& mean, const Lens& lens) {
  std::array<std::vector<double>, 3> codes;
  for (int y = 0; y < mean.format.height; ++y)
    for (int x = 0; x < mean.format.width; ++x)
      if (lens.theta_rad(Vec2d(x, y)) < lens.max_theta_rad)
        codes[static_cast<std::size_t>(colour_of(mean.format, x, y))].push_back(
            mean.code[static_cast<std::size_t>(y) * static_cast<std::size_t>(mean.format.width) +
                      static_cast<std::size_t>(x)]);
  std::vector<double> out;
  for (std::vector<double>& of_colour : codes) {
    if (of_colour.empty()) continue;
    out.push_back(median(std::move(of_colour)));
  }
  std::sort(out.begin(), out.end());
  return out;
}

Error bad(const std::string& name, const char* format, double code, double luminance, double limit) {
  char text[240];
  std::snprintf(text, sizeof text, format, code, luminance, limit);
  return {ErrorKind::bad_input, name + text};
}

}  // namespace

Status check_field(const Lens& lens, bool mosaic) {
  const double edge = lens.max_theta_rad - (mosaic ? 3 : 1.5) / lens.focal.minCoeff();
  std::size_t inside = 0;
  for (int y = 0; y < lens.image_size[1] && inside < kFewestPixels; ++y)
    for (int x = 0; x < lens.image_size[0]; ++x) inside += lens.theta_rad(Vec2d(x, y)) < edge;
  if (inside >= kFewestPixels) return {};
  char text[240];
  std::snprintf(
      text, sizeof text,
      "max_theta_deg = %g with focal = [%g, %g]: the lens's field holds %zu whole pixels: allowed at "
      "least %zu",
      lens.max_theta_rad * 180 / kPi, lens.focal.x(), lens.focal.y(), inside, kFewestPixels);
  return Error{ErrorKind::bad_input, text};
}

Status check_is_dark(const MeanFrame& mean, const Lens& lens, const Response& response,
                     const std::string& name) {
  const std::vector<double> codes = levels(mean, lens);
  const double limit = darkest_lit_code(response);
  if (codes.empty() || codes.back() <= limit) return {};
  return bad(name,
             ": not dark: code %.6g in the lens's field, %.3g cd/m²: allowed up to code %.6g, about the "
             "response's darkness; cap the lens",
             codes.back(), response.luminance_cd_m2(codes.back()), limit);
}

Status check_is_lit(const MeanFrame& mean, const Lens& lens, const Response& response,
                    const std::string& name) {
  const std::vector<double> codes = levels(mean, lens);
  if (codes.empty()) return {};
  const double code = codes.front(), limit = darkest_lit_code(response);
  const double luminance = std::max(0.0, response.luminance_cd_m2(code));
  if (!(code > limit))
    return bad(
        name,
        ": too dark for an even scene: code %.6g in the lens's field, %.3g cd/m²: allowed above code %.6g",
        code, luminance, limit);
  if (response.dluminance_dcode(code) > kCoarsest * luminance)
    return bad(name,
               ": too dark for an even scene: at code %.6g in the lens's field, %.3g cd/m², one code is more "
               "than %g of the light: allowed up to that",
               code, luminance, kCoarsest);
  return {};
}

}  // namespace lightwell::calibration
