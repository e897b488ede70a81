// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "lighting/polar_map.h"

// Synthetic light: what the benchmarks' maps and sequences are painted with. All deterministic.
namespace lightwell::bench {

// Directions of all bins' centres.
std::vector<Vec3f> bin_directions(const PolarGrid& grid);

// Every bin the radiance of its centre's direction.
void paint(PolarMap& map, const std::function<Rgb(const Vec3d&)>& radiance);

// Adds a disc with an edge of one degree, however it lies on the grid always of this illuminance (lux facing it;
// also where part of it is below the map's edge). radius at least a quarter of a degree: some bin is then always in it
void add_disc(PolarMap& map, const Vec3d& centre, double radius_deg, const Rgb& illuminance);
Vec3d from_degrees(double zenith_deg, double azimuth_deg);

// Blends a rectangle of zenith and azimuth toward a radiance, its edges soft over a degree: share 1 is opaque.
struct Rectangle {
  double zenith_from_deg, zenith_to_deg, azimuth_from_deg, azimuth_to_deg;
};
void blend_rectangle(PolarMap& map, const Rectangle& where, const Rgb& radiance, double share = 1);

// Blue sky that brightens toward the horizon, with soft clouds; no sun. About 2000 cd/m².
Rgb sky_radiance(const Vec3d& direction);
// A dim room with two windows and lamps of several colours, over the whole sphere.
Rgb room_radiance(const Vec3d& direction);

// Smooth noise of the plane, 0 to 1, period 1 a cell.
double value_noise(double x, double y, std::uint32_t seed);
// Several octaves of it, 0 to 1.
double cloud_noise(double x, double y, std::uint32_t seed);

// Multiplies every bin by 1 + sigma · (bell-shaped noise of mean 0 and variance 1), never below 0; other noise every frame.
void add_relative_noise(PolarMap& map, double sigma, std::uint32_t frame);

// The whole-sphere map seen by a camera turned by an angle-axis vector, on the hemisphere's grid: radiance bilinear
// between bins.
class TurnedView {
 public:
  TurnedView(PolarMap sphere, const PolarGrid& grid);
  void look(const Vec3d& turn_rad, PolarMap& map) const;

 private:
  PolarMap sphere_;
  std::vector<Vec3f> directions_;
};

// The map turned about +Y by an angle: whole sectors exactly, the rest divided between two sectors by area.
void turn_about_zenith(const PolarMap& from, double angle_deg, PolarMap& map);

}  // namespace lightwell::bench
