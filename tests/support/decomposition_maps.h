// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <random>

#include "lighting/light_set.h"
#include "lighting/polar_map.h"
#include "tests/support/sampling_maps.h"

// Maps to decompose, and what becomes of them when turned, scaled or seen by fewer bins.
namespace lightwell::test {

inline constexpr double kDegree = kPi / 180;

// A gradient, a sun of 3°, a lamp of 6° and some texture.
inline PolarMap outdoor(const PolarGrid& grid) {
  PolarMap map = PolarMap::make(grid, 3);
  std::mt19937 generator(8);
  std::uniform_real_distribution<float> texture(0.5f, 1.5f);
  const Vec3d sun = direction_from_spherical({40 * kDegree, 100 * kDegree});
  const Vec3d lamp = direction_from_spherical({75 * kDegree, 290 * kDegree});
  for (int ring = 0; ring < grid.rings; ++ring)
    for (int sector = 0; sector < grid.sectors; ++sector) {
      const Vec3d d = grid.bin_direction(ring, sector);
      Rgb value = Rgb(0.2f, 0.4f, 0.8f) * (1.2f + static_cast<float>(d.y())) * texture(generator);
      if (d.dot(sun) > std::cos(3 * kDegree)) value += Rgb(300, 280, 240);
      if (d.dot(lamp) > std::cos(6 * kDegree)) value += Rgb(9, 6, 2);
      set_bin(map, ring, sector, value);
    }
  return map;
}

inline PolarMap scaled(PolarMap map, float factor) {
  for (float& value : map.radiance) value *= factor;
  return map;
}

inline PolarMap one_bin(const PolarGrid& grid, int ring, int sector, float value) {
  PolarMap map = PolarMap::make(grid, 3);
  set_bin(map, ring, sector, Rgb::Constant(value));
  return map;
}

// Sector s comes to s + by.
inline PolarMap turned(const PolarMap& map, int by) {
  PolarMap result = map;
  for (int ring = 0; ring < map.grid.rings; ++ring)
    for (int sector = 0; sector < map.grid.sectors; ++sector) {
      const auto bin = static_cast<std::size_t>(ring * map.grid.sectors + sector);
      set_bin(result, ring, sector + by, map.rgb(bin));
    }
  return result;
}

// Two by two bins become one, with all their light.
inline PolarMap halved(const PolarMap& map) {
  PolarGrid grid = map.grid;
  grid.rings /= 2;
  grid.sectors /= 2;
  PolarMap result = PolarMap::make(grid, map.channels);
  for (int ring = 0; ring < grid.rings; ++ring)
    for (int sector = 0; sector < grid.sectors; ++sector) {
      Rgbd sum = Rgbd::Zero();
      for (int k = 0; k < 4; ++k) {
        const auto bin = static_cast<std::size_t>((2 * ring + k / 2) * map.grid.sectors + 2 * sector + k % 2);
        sum += map.rgb(bin).cast<double>() * static_cast<double>(map.solid_angle_sr[bin]);
      }
      const auto bin = static_cast<std::size_t>(ring * grid.sectors + sector);
      set_bin(result, ring, sector, (sum / static_cast<double>(result.solid_angle_sr[bin])).cast<float>());
    }
  return result;
}

inline Rgbd sum(const LightSet& set) {
  Rgbd total = Rgbd::Zero();
  for (const auto& light : set.lights) total += light.illuminance.cast<double>();
  return total;
}

}  // namespace lightwell::test
