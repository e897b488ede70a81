// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/response.h"

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

}  // namespace

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
  // The model increases by its own form; what can still fail is its scale. The sun is 1.6e9 cd/m².
  const double brightest = response.luminance_cd_m2(response.clip_code);
  if (!(brightest > 0 && brightest <= 1e20))
    return field_error("response: luminance at clip_code", brightest, "above 0, at most 1e20 cd/m2");
  return {};
}

}  // namespace lightwell
