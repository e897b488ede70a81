// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/fade_lights.h"

namespace lightwell::render {

LightSet fade_lights(const LightSet& set, double count) {
  const auto fewer = static_cast<std::size_t>(count);
  const auto share = static_cast<float>(count - static_cast<double>(fewer));
  const LightSet without = take_lights(set, fewer);
  if (share == 0 || fewer >= set.lights.size()) return without;
  LightSet faded = take_lights(set, fewer + 1);
  faded.lights.back().illuminance *= share;
  for (std::size_t i = 0; i < fewer; ++i) {
    DirectionalLight& light = faded.lights[i];
    const DirectionalLight& other = without.lights[i];
    const Vec3f mean = share * light.direction + (1 - share) * other.direction;
    if (mean.norm() > 1e-3f) light.direction = mean.normalized();
    light.illuminance = share * light.illuminance + (1 - share) * other.illuminance;
    light.angular_radius_rad = share * light.angular_radius_rad + (1 - share) * other.angular_radius_rad;
  }
  return faded;
}

}  // namespace lightwell::render
