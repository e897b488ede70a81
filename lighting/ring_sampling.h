// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lighting/azimuth_seam.h"
#include "lighting/concentric_map.h"
#include "lighting/light_arrays.h"
#include "lighting/ring_distribution.h"

// Importance sampling of a polar map by inverse transform, in the two ways Havran et al. 2005, section 3.1
// compare.
//
// Both choose a ring by the cumulative power of the rings (coordinate t) and an azimuth by the cumulative
// power along the ring, counted from the seam (coordinate s); inside a bin places are uniform in solid angle.
// They differ in how a point of the unit square becomes (t, s), and in whether neighbouring rings share their
// distributions. Each is the trio sample (square to direction), pdf (of that, per steradian) and invert
// (direction to square); pdf integrates to 1 over the map's cap. A black map is sampled uniformly over the
// cap.
//
// A sampler is a light view: the distribution and the seam must outlive it. Thread-safe, allocates nothing.
namespace lightwell {

struct RingCoordinates {
  double t = 0;  // share of the map's power inside of this place's ring position, [0, 1]
  double s = 0;  // place on the circle, [0, 1)
};

// A point of the map that a sampler chose.
struct MapPlace {
  RingPlace ring;
  SectorPlace sector;
  RingBlend blend;
};

using MapPlaces = std::array<MapPlace, RingDistribution::kTogether>;

// Row, then column. source: Pharr and Humphreys 2004; Havran et al. 2005, section 3.1
class StandardInversion {
 public:
  StandardInversion(const RingDistribution& map, const AzimuthSeam& seam) : map_(&map), seam_(&seam) {}

  static RingCoordinates warp(const Vec2d& square) { return {square.x(), square.y()}; }
  [[nodiscard]] MapPlace locate(const RingCoordinates& c) const noexcept;
  void locate(const RingCoordinates* c, MapPlaces& places) const noexcept;  // kTogether of them
  [[nodiscard]] Vec3d sample(const Vec2d& square) const noexcept;
  [[nodiscard]] double pdf(const Vec3d& direction) const noexcept;
  [[nodiscard]] Vec2d invert(const Vec3d& direction) const noexcept;
  [[nodiscard]] const RingDistribution& map() const { return *map_; }

 private:
  [[nodiscard]] RingBlend blend_at(const RingPlace& place) const noexcept;

  const RingDistribution* map_;
  const AzimuthSeam* seam_;
};

// Concentric map of the square to the disc; t = r² to the rings, the disc's angle to azimuth; the azimuth's
// distribution is interpolated between the two nearest rings, so that a small step in the square is a small
// step on the hemisphere.
//
// The paper interpolates the *normalised* cumulative distributions. A black ring then counts as much as the
// sun's: with one bright bin a quarter of the lights lands in the dark, and a residual error stays at any
// count. Weighted by ring power (by_power, the default) the interpolation is that of radiance itself, and a
// black neighbour has no weight.
class HavranTransform {
 public:
  enum class Interpolation { by_power, printed };

  HavranTransform(const RingDistribution& map, const AzimuthSeam& seam,
                  Interpolation interpolation = Interpolation::by_power)
      : map_(&map), seam_(&seam), interpolation_(interpolation) {}

  static RingCoordinates warp(const Vec2d& square) {
    const DiscPoint p = disc_from_square(square);
    return {p.radius2, p.turns < 1 ? p.turns : 0};
  }
  [[nodiscard]] MapPlace locate(const RingCoordinates& c) const noexcept;
  void locate(const RingCoordinates* c, MapPlaces& places) const noexcept;  // kTogether of them
  [[nodiscard]] Vec3d sample(const Vec2d& square) const noexcept;
  [[nodiscard]] double pdf(const Vec3d& direction) const noexcept;
  [[nodiscard]] Vec2d invert(const Vec3d& direction) const noexcept;
  [[nodiscard]] const RingDistribution& map() const { return *map_; }

 private:
  [[nodiscard]] RingBlend blend_at(const RingPlace& place) const noexcept;

  const RingDistribution* map_;
  const AzimuthSeam* seam_;
  Interpolation interpolation_;
};

// Points of the square as ring coordinates, once for all frames.
template <class Sampler>
std::vector<RingCoordinates> warp_points(std::span<const Vec2d> square) {
  std::vector<RingCoordinates> warped;
  warped.reserve(square.size());
  for (const Vec2d& p : square) warped.push_back(Sampler::warp(p));
  return warped;
}

// One light a point, each with the same luminous power (map's total / N) and the colour of the bin it lies
// in; then each channel is scaled so that the lights sum to the map's total. A scale stops at 4 (a channel
// that the lights hardly meet would come out in one of them); what is missing then is spread evenly, so the
// total holds for every map. A black map gives lights of no power, spread over the cap. lights: of the
// points' size; radiance: the map the sampler's distribution was built from. Allocates nothing.
void sample_lights(const StandardInversion& sampler, const PolarMap& radiance,
                   std::span<const RingCoordinates> points, LightArrays& lights) noexcept;
void sample_lights(const HavranTransform& sampler, const PolarMap& radiance,
                   std::span<const RingCoordinates> points, LightArrays& lights) noexcept;

}  // namespace lightwell
