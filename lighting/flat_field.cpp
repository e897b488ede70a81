// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/flat_field.h"

#include <cmath>
#include <string>

#include "lighting/field_error.h"
#include "lighting/polynomial.h"

namespace lightwell {

Status check(const FlatField& flat, const Lens& lens) {
  const bool any_size = flat.image_size == std::array<int, 2>{0, 0};
  if (!any_size && flat.image_size != lens.image_size) {
    const std::size_t axis = flat.image_size[0] != lens.image_size[0] ? 0 : 1;
    return field_error("flat.image_size[" + std::to_string(axis) + "]", flat.image_size[axis],
                       std::to_string(lens.image_size[axis]) + ", the lens's image_size");
  }
  const std::size_t pixels =
      static_cast<std::size_t>(flat.image_size[0]) * static_cast<std::size_t>(flat.image_size[1]);
  if (!flat.offset_codes.empty() && flat.offset_codes.size() != pixels)
    return field_error("flat.offset_codes: number of values", static_cast<double>(flat.offset_codes.size()),
                       "0 or width x height = " + std::to_string(pixels));
  for (std::size_t i = 0; i < flat.offset_codes.size(); ++i)
    if (!(std::abs(flat.offset_codes[i]) <= 65535))
      return field_error("flat.offset_codes[" + std::to_string(i) + "]",
                         static_cast<double>(flat.offset_codes[i]), "-65535 to 65535");
  if (!flat.gain.empty() && flat.gain.size() != pixels)
    return field_error("flat.gain: number of values", static_cast<double>(flat.gain.size()),
                       "0 or width x height = " + std::to_string(pixels));
  for (std::size_t i = 0; i < flat.gain.size(); ++i)
    if (!(flat.gain[i] >= 0.01F && flat.gain[i] <= 100))
      return field_error("flat.gain[" + std::to_string(i) + "]", static_cast<double>(flat.gain[i]),
                         "0.01 to 100");
  for (std::size_t i = 0; i < 3; ++i)
    if (!(std::abs(flat.vignetting[i]) <= 1e3))
      return field_error("flat.vignetting[" + std::to_string(i) + "]", flat.vignetting[i], "-1000 to 1000");
  const auto& v = flat.vignetting;
  const auto [t, lowest] =
      polynomial_minimum({1, v[0], v[1], v[2]}, 0, lens.max_theta_rad * lens.max_theta_rad);
  if (lowest < 1e-3)
    return field_error(
        "flat.vignetting: transmission at " + std::to_string(std::sqrt(t) * 180 / kPi) + " degrees", lowest,
        "at least 0.001 over the field");
  return {};
}

}  // namespace lightwell
