// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lighting/sampling/azimuth_seam.h"
#include "lighting/sampling/concentric_map.h"
#include "lighting/sampling/light_arrays.h"
#include "lighting/sampling/ring_distribution.h"

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

// t: share of the map's power inside of this place's ring position, [0, 1]; s: place on the circle, [0, 1).
using RingCoordinates = light_kernel::Point;

// What both methods share; Method has warp and unwarp (square to coordinates and back) and blending().
template <class Method>
class RingSampler {
 public:
  RingSampler(const RingDistribution& map, const AzimuthSeam& seam) : map_(&map), seam_(&seam) {}

  // The places of points, one each.
  void locate(std::span<const RingCoordinates> points, std::span<MapPlace> places) const noexcept;
  [[nodiscard]] Vec3d sample(const Vec2d& square) const noexcept;
  [[nodiscard]] double pdf(const Vec3d& direction) const noexcept;
  [[nodiscard]] Vec2d invert(const Vec3d& direction) const noexcept;
  [[nodiscard]] const RingDistribution& map() const { return *map_; }

 private:
  [[nodiscard]] light_kernel::Blending blending() const {
    return static_cast<const Method&>(*this).blending();
  }
  [[nodiscard]] RingBlend blend_at(const RingPlace& ring) const noexcept;

  const RingDistribution* map_;
  const AzimuthSeam* seam_;
};

// Row, then column. source: Pharr and Humphreys 2004; Havran et al. 2005, section 3.1
class StandardInversion : public RingSampler<StandardInversion> {
 public:
  using RingSampler::RingSampler;

  static RingCoordinates warp(const Vec2d& square) { return {square.x(), square.y()}; }
  static Vec2d unwarp(const RingCoordinates& c) { return {c.t, c.s}; }
  [[nodiscard]] static light_kernel::Blending blending() { return light_kernel::Blending::own; }
};

// Concentric map of the square to the disc; t = r² to the rings, the disc's angle to azimuth; the azimuth's
// distribution is interpolated between the two nearest rings, so that a small step in the square is a small
// step on the hemisphere.
//
// The paper interpolates the *normalised* cumulative distributions. A black ring then counts as much as the
// sun's: with one bright bin a quarter of the lights lands in the dark, and a residual error stays at any
// count. Weighted by ring power (by_power, the default) the interpolation is that of radiance itself, and a
// black neighbour has no weight.
class HavranTransform : public RingSampler<HavranTransform> {
 public:
  enum class Interpolation { by_power, printed };

  HavranTransform(const RingDistribution& map, const AzimuthSeam& seam,
                  Interpolation interpolation = Interpolation::by_power)
      : RingSampler(map, seam), interpolation_(interpolation) {}

  static RingCoordinates warp(const Vec2d& square) {
    const DiscPoint p = disc_from_square(square);
    return {p.radius2, p.turns < 1 ? p.turns : 0};
  }
  static Vec2d unwarp(const RingCoordinates& c) { return square_from_disc({c.t, c.s}); }
  [[nodiscard]] light_kernel::Blending blending() const {
    return interpolation_ == Interpolation::by_power ? light_kernel::Blending::by_power
                                                     : light_kernel::Blending::printed;
  }

 private:
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
