// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "daemon/simulator/scene.h"
#include "lighting/direction.h"

namespace lightwell::simulator {

// A smooth layer whose upper half is painted by radiance(direction) in cd/m², pixel centre by pixel centre; black below.
template <class Radiance>
Layer paint_upper_half(int width, int height, Radiance radiance) {
  Layer out{{width, height, {}}, true};
  out.image.pixels.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), Rgb::Zero());
  for (int y = 0; y < height / 2; ++y)
    for (int x = 0; x < width; ++x) {
      const Rgbd value = radiance(direction_from_lat_long((x + 0.5) / width, (y + 0.5) / height));
      out.image.at(x, y) = value.cast<float>();
    }
  return out;
}

}  // namespace lightwell::simulator
