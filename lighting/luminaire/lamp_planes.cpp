// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/luminaire/lamp_planes.h"

#include <algorithm>
#include <cmath>

namespace lightwell {

// With y = 1 − x for the two right-hand weights.
std::array<double, 4> cubic_weights(double x) noexcept {
  const double y = 1 - x;
  return {-0.5 * x * y * y, 1 + x * x * (1.5 * x - 2.5), 1 + y * y * (1.5 * y - 2.5), -0.5 * y * x * x};
}

Rgbd LampImages::at(int u, int v, const Vec2d& measurement) const {
  if (!(measurement.array() >= planes.low_m.array()).all() ||
      !(measurement.array() <= planes.high_m.array()).all())
    return Rgbd::Zero();
  const Vec2d place = (measurement - planes.low_m).cwiseQuotient(planes.pixel_m()).array() - 0.5;
  const Rgb* pixels = image(u, v);
  const auto [width, height] = planes.pixels;
  const Vec2d corner = place.array().floor();
  const auto across = cubic_weights(place.x() - corner.x()), down = cubic_weights(place.y() - corner.y());
  Rgbd sum = Rgbd::Zero();
  for (int j = 0; j < 4; ++j) {
    const int row = std::clamp(static_cast<int>(corner.y()) + j - 1, 0, height - 1);
    Rgbd of_row = Rgbd::Zero();
    for (int i = 0; i < 4; ++i) {
      const int column = std::clamp(static_cast<int>(corner.x()) + i - 1, 0, width - 1);
      of_row += across[static_cast<std::size_t>(i)] *
                pixels[static_cast<std::ptrdiff_t>(row) * width + column].cast<double>();
    }
    sum += down[static_cast<std::size_t>(j)] * of_row;
  }
  return sum;
}

}  // namespace lightwell
