// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "lighting/light_set.h"
#include "lighting/polar_map.h"

// Polar maps whose sampling is hard, shared by the tests of everything that draws lights from a map.
namespace lightwell::test {

inline void set_bin(PolarMap& map, int ring, int sector, const Rgb& radiance) {
  const int s = ((sector % map.grid.sectors) + map.grid.sectors) % map.grid.sectors;
  const std::size_t bin = static_cast<std::size_t>(ring) * static_cast<std::size_t>(map.grid.sectors) +
                          static_cast<std::size_t>(s);
  for (int c = 0; c < map.channels; ++c) map.plane(c)[bin] = radiance[c];
}

inline PolarMap constant_map(const PolarGrid& grid, const Rgb& radiance, int channels = 3) {
  PolarMap map = PolarMap::make(grid, channels);
  for (int c = 0; c < channels; ++c)
    for (float& v : map.plane(c)) v = radiance[c];
  return map;
}

// What the map itself is: a light in every bin's centre.
inline LightSet every_bin_a_light(const PolarMap& map) {
  LightSet set;
  for (int ring = 0; ring < map.grid.rings; ++ring)
    for (int sector = 0; sector < map.grid.sectors; ++sector) {
      const auto bin = static_cast<std::size_t>(ring * map.grid.sectors + sector);
      DirectionalLight light;
      light.direction = map.grid.bin_direction(ring, sector).cast<float>();
      light.illuminance = map.rgb(bin) * map.solid_angle_sr[bin];
      set.lights.push_back(light);
    }
  return set;
}

// Independent bins over a few powers of ten, some black.
inline PolarMap random_map(const PolarGrid& grid, unsigned seed, int channels = 3) {
  PolarMap map = PolarMap::make(grid, channels);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> exponent(-2, 2);
  for (std::size_t bin = 0; bin < grid.size(); ++bin) {
    const bool black = random() % 8 == 0;
    for (int c = 0; c < channels; ++c) map.plane(c)[bin] = black ? 0.0f : std::pow(10.0f, exponent(random));
  }
  return map;
}

// A smooth blue sky, brighter toward the horizon, and a sun of one degree that keeps its power wherever it
// stands: its radiance is divided over the bins it overlaps. azimuth and zenith angle in degrees.
inline PolarMap sun_and_sky(const PolarGrid& grid, double azimuth_deg, double zenith_deg, double sun_share,
                            int channels = 3) {
  PolarMap map = PolarMap::make(grid, channels);
  double sky = 0;
  for (int k = 0; k < grid.rings; ++k) {
    const double theta = grid.theta_max_rad * (k + 0.5) / grid.rings;
    for (int s = 0; s < grid.sectors; ++s) {
      const double value = 1 + 2 * theta * theta;
      set_bin(map, k, s, Rgb(0.5f, 0.8f, 1.4f) * static_cast<float>(value));
      sky += value * static_cast<double>(luminance(Rgb(0.5f, 0.8f, 1.4f))) * grid.bin_solid_angle_sr(k);
    }
  }
  // Two sectors around the azimuth, in the ring of the zenith angle, bilinear.
  const double position = azimuth_deg / 360 * grid.sectors - 0.5;
  const int first = static_cast<int>(std::floor(position));
  const double part = position - first;
  const int ring =
      std::min(grid.rings - 1, static_cast<int>(zenith_deg * kPi / 180 / grid.theta_max_rad * grid.rings));
  const double power = sky * sun_share / (1 - sun_share) / grid.bin_solid_angle_sr(ring);
  for (int i = 0; i < 2; ++i) {
    const auto radiance = static_cast<float>(power * (i == 0 ? 1 - part : part));
    const int s = ((first + i) % grid.sectors + grid.sectors) % grid.sectors;
    const std::size_t bin =
        static_cast<std::size_t>(ring) * static_cast<std::size_t>(grid.sectors) + static_cast<std::size_t>(s);
    set_bin(map, ring, s, map.rgb(bin) + Rgb::Constant(radiance));
  }
  return map;
}

struct NamedMap {
  std::string name;
  PolarMap map;
};

// What every sampler must take: sizes, ranges, single bins, black.
inline std::vector<NamedMap> hard_maps() {
  std::vector<NamedMap> maps;
  const PolarGrid hemisphere{18, 40, kPi / 2};
  const PolarGrid sphere{20, 33, kPi};
  const PolarGrid wide{13, 24, 100 * kPi / 180};
  maps.push_back({"constant", constant_map(hemisphere, Rgb(1, 2, 3))});
  maps.push_back({"constant sphere", constant_map(sphere, Rgb(1, 2, 3))});
  maps.push_back({"one bin of one", constant_map({1, 1, kPi / 2}, Rgb(1, 2, 3))});
  maps.push_back({"three by five", random_map({3, 5, kPi / 2}, 1)});
  maps.push_back({"random hemisphere", random_map(hemisphere, 2)});
  maps.push_back({"random sphere", random_map(sphere, 3)});
  maps.push_back({"random wide lens, monochrome", random_map(wide, 4, 1)});
  const auto single = [&](const char* name, int ring, int sector) {
    PolarMap map = PolarMap::make(hemisphere, 3);
    set_bin(map, ring, sector, Rgb(3, 2, 1));
    maps.push_back({name, map});
  };
  single("one bin at the pole", 0, 7);
  single("one bin at the horizon", 17, 7);
  single("one bin before the seam", 9, 39);
  single("one bin after the seam", 9, 0);
  PolarMap range = random_map(hemisphere, 5);
  set_bin(range, 6, 11, Rgb::Constant(1e8f));
  maps.push_back({"sun of 1e8", range});
  return maps;
}

}  // namespace lightwell::test
