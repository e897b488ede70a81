// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lighting/lens.h"
#include "lighting/result.h"

namespace lightwell {

// What differs from pixel to pixel.
struct FlatField {
  std::array<int, 2> image_size = {0, 0};  // width, height; {0,0}: no fixed pattern for any size
  std::vector<float> offset_codes;  // [height][width], added by the sensor to the ideal code; empty: none
  std::array<double, 3> vignetting = {0, 0, 0};  // transmission T(θ) = 1 + v1 θ² + v2 θ⁴ + v3 θ⁶, in (0, 1]
  std::vector<float> gain = {};                  // [height][width], light that a pixel takes for 1; empty: 1

  [[nodiscard]] double transmission(double theta_rad) const {
    const double t = theta_rad * theta_rad;
    return 1 + t * (vignetting[0] + t * (vignetting[1] + t * vignetting[2]));
  }
};

// Sizes agree with the lens, offsets finite, gains between 0.01 and 100, transmission positive over the field.
Status check(const FlatField& flat, const Lens& lens);

}  // namespace lightwell
