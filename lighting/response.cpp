// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/response.h"

#include <algorithm>
#include <string>

#include "lighting/field_error.h"

namespace lightwell {
namespace {

Status check_model(const LogResponse& m) {
  if (!std::isfinite(m.a)) return field_error("response.a", m.a, "a finite code");
  if (!(m.b > 0 && m.b <= 1e6)) return field_error("response.b", m.b, "above 0, at most 1e6 codes");
  if (!(m.c >= 0 && m.c <= 1e12)) return field_error("response.c", m.c, "0 to 1e12 cd/m2");
  return {};
}

Status check_model(const LinearResponse& m) {
  if (!std::isfinite(m.black)) return field_error("response.black", m.black, "a finite code");
  if (!(m.gain > 0 && m.gain <= 1e12))
    return field_error("response.gain", m.gain, "above 0, at most 1e12 codes per cd/m2");
  return {};
}

Status check_model(const LinLogResponse& m) {
  if (!std::isfinite(m.black)) return field_error("response.black", m.black, "a finite code");
  if (!(m.gain > 0 && m.gain <= 1e12))
    return field_error("response.gain", m.gain, "above 0, at most 1e12 codes per cd/m2");
  if (!(m.knee_cd_m2 > 0 && m.knee_cd_m2 <= 1e20))
    return field_error("response.knee_cd_m2", m.knee_cd_m2, "above 0, at most 1e20 cd/m2");
  return {};
}

Status check_model(const PiecewiseLinearResponse& m) {
  if (m.points.size() < 2 || m.points.size() > 65536)
    return field_error("response: number of knee points", static_cast<double>(m.points.size()), "2 to 65536");
  for (std::size_t i = 0; i < m.points.size(); ++i) {
    const auto& [luminance, code] = m.points[i];
    const std::string at = "[" + std::to_string(i) + "]";
    if (!(luminance >= 0 && luminance <= 1e20))
      return field_error("response.luminance_cd_m2" + at, luminance, "0 to 1e20 cd/m2");
    if (!(std::abs(code) <= 65535)) return field_error("response.code" + at, code, "-65535 to 65535");
    if (i == 0) continue;
    const auto& before = m.points[i - 1];
    if (!(luminance > before.luminance_cd_m2))
      return field_error("response.luminance_cd_m2" + at, luminance,
                         "values that increase from point to point");
    if (!(code > before.code))
      return field_error("response.code" + at, code, "values that increase from point to point");
  }
  return {};
}

void scale_codes(LogResponse& m, double scale) {
  m.a *= scale;
  m.b *= scale;
}
void scale_codes(LinearResponse& m, double scale) {
  m.black *= scale;
  m.gain *= scale;
}
void scale_codes(LinLogResponse& m, double scale) {
  m.black *= scale;
  m.gain *= scale;
}
void scale_codes(PiecewiseLinearResponse& m, double scale) {
  for (auto& point : m.points) point.code *= scale;
}

using Point = PiecewiseLinearResponse::Point;

// The upper end of the line that answers for `value`, among points ordered by `key`.
std::size_t line_end(const std::vector<Point>& points, double value, double Point::*key) {
  const auto above = std::upper_bound(points.begin() + 1, points.end() - 1, value,
                                      [key](double v, const Point& p) { return v < p.*key; });
  return static_cast<std::size_t>(above - points.begin());
}

}  // namespace

double PiecewiseLinearResponse::code(double luminance) const {
  const std::size_t end = line_end(points, luminance, &Point::luminance_cd_m2);
  const Point &p = points[end - 1], &q = points[end];
  return p.code +
         (luminance - p.luminance_cd_m2) * (q.code - p.code) / (q.luminance_cd_m2 - p.luminance_cd_m2);
}

double PiecewiseLinearResponse::luminance_cd_m2(double at_code) const {
  const std::size_t end = line_end(points, at_code, &Point::code);
  const Point &p = points[end - 1], &q = points[end];
  return p.luminance_cd_m2 + (at_code - p.code) * (q.luminance_cd_m2 - p.luminance_cd_m2) / (q.code - p.code);
}

double PiecewiseLinearResponse::dluminance_dcode(double at_code) const {
  const std::size_t end = line_end(points, at_code, &Point::code);
  const Point &p = points[end - 1], &q = points[end];
  return (q.luminance_cd_m2 - p.luminance_cd_m2) / (q.code - p.code);
}

Response with_bits(const Response& response, int bits) {
  Response out = response;
  const double scale = std::ldexp(1.0, bits - response.bits);
  std::visit([scale](auto& model) { scale_codes(model, scale); }, out.model);
  const double top = std::ldexp(1.0, bits) - 1;
  const bool clips_at_top = response.clip_code >= std::ldexp(1.0, response.bits) - 1;
  out.bits = bits;
  out.black_code = std::floor(response.black_code * scale);
  out.clip_code = clips_at_top ? top : std::floor(response.clip_code * scale);
  return out;
}

Status check(const Response& response) {
  if (response.bits < 1 || response.bits > 16) return field_error("response.bits", response.bits, "1 to 16");
  const double top = std::ldexp(1.0, response.bits) - 1;
  const std::string range = "to " + std::to_string(static_cast<int>(top)) + ", the largest code";
  if (!(response.black_code >= 0 && response.black_code < top))
    return field_error("response.black_code", response.black_code, "0 " + range);
  if (!(response.clip_code > response.black_code && response.clip_code <= top))
    return field_error("response.clip_code", response.clip_code, "above black_code " + range);
  if (!(response.reference_exposure_us > 0 && response.reference_exposure_us <= 1e9))
    return field_error("response.reference_exposure_us", response.reference_exposure_us,
                       "above 0, at most 1e9");
  if (const Status model = std::visit([](const auto& m) { return check_model(m); }, response.model); !model)
    return model;
  // The model increases, by its own form or by its points; what can still fail is its scale. The sun is
  // 1.6e9 cd/m².
  const double brightest = response.luminance_cd_m2(response.clip_code);
  if (!(brightest > 0 && brightest <= 1e20))
    return field_error("response: luminance at clip_code", brightest, "above 0, at most 1e20 cd/m2");
  return {};
}

}  // namespace lightwell
