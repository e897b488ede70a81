// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/sampling/ring_sampling.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lighting/result.h"

namespace lightwell {
namespace {

double turns_of(const SectorPlace& place, int sectors) {
  return (place.sector + place.fraction) / sectors;
}

// On the circle of radius sin θ at height cos θ, from 1 − cos θ: nothing cancels near the zenith.
Vec3d direction_of(double one_minus_cos, double turns) {
  const double sin_theta = std::sqrt(std::max(0.0, one_minus_cos * (2 - one_minus_cos)));
  const double lambda = 2 * kPi * turns;
  return {sin_theta * std::sin(lambda), 1 - one_minus_cos, sin_theta * std::cos(lambda)};
}

double ring_coordinate(const RingDistribution& map, const RingPlace& ring) noexcept {
  const double total = map.total_power();
  if (total > 0) return (map.ring_start(ring.ring) + ring.fraction * map.ring_power(ring.ring)) / total;
  return map.one_minus_cos(ring) / map.cap();
}

// Density per steradian at a direction: of the ring over t, of the azimuth along it, over the bin's solid
// angle.
double density(const RingDistribution& map, const RingPlace& ring, const RingBlend& blend,
               double turns) noexcept {
  const double total = map.total_power();
  if (total <= 0) return 1 / (2 * kPi * map.cap());
  const int sectors = map.grid().sectors;
  const int sector = std::min(static_cast<int>(turns * sectors), sectors - 1);
  const double ring_share = map.ring_power(ring.ring) / total;
  const double blend_power = map.power(blend);
  if (ring_share <= 0 || blend_power <= 0) return 0;
  return ring_share * map.bin_power(blend, sector) / blend_power / map.grid().bin_solid_angle_sr(ring.ring);
}

struct MapCoordinates {
  RingPlace ring;
  double turns;
};

MapCoordinates map_coordinates(const RingDistribution& map, const Vec3d& direction) noexcept {
  const Spherical s = spherical_from_direction(direction);
  return {map.ring_of(s.theta_rad), s.lambda_rad / (2 * kPi)};
}

bool outside(const RingDistribution& map, const Vec3d& direction) {
  // The edge itself belongs to the map, to rounding.
  return spherical_from_direction(direction).theta_rad > map.grid().theta_max_rad * (1 + 1e-12);
}

// Factor and evenly spread rest that bring a channel's sum to its total.
struct Correction {
  float scale = 1;
  float rest = 0;
};

Correction correction(double sum, double total, std::size_t count) noexcept {
  constexpr double kLargestScale = 4;
  const double scale = sum > 0 ? std::min(total / sum, kLargestScale) : 0;
  const double rest = std::max(0.0, total - sum * scale) / static_cast<double>(count);
  // Within rounding of the sum nothing is missing.
  return {static_cast<float>(scale),
          rest * static_cast<double>(count) > 1e-6 * total ? static_cast<float>(rest) : 0.0f};
}

void match_total(std::vector<float>& channel, double total) noexcept {
  const Correction c = correction(sum_of(channel), total, channel.size());
  for (float& v : channel) v = v * c.scale + c.rest;
}

// Colour of the place's bin at the given luminance. Light of the neighbouring ring that falls on a black bin
// has the neighbour's colour; where both are black (the printed interpolation goes there), the map's mean.
Rgb colour_at(const PolarMap& map, const MapPlace& place, const Rgb& mean, float power) noexcept {
  const auto bin_in = [&](int ring) {
    return static_cast<std::size_t>(ring) * static_cast<std::size_t>(map.grid.sectors) +
           static_cast<std::size_t>(place.sector.sector);
  };
  Rgb colour = map.rgb(bin_in(place.ring.ring));
  float y = luminance(colour);
  if (y <= 0) {
    colour = map.rgb(bin_in(place.neighbour));
    y = luminance(colour);
  }
  return y > 0 ? Rgb(colour * (power / y)) : mean;
}

// A black map is sampled uniformly in solid angle over the cap.
MapPlace place_on_black(const RingDistribution& map, const AzimuthSeam& seam,
                        const RingCoordinates& c) noexcept {
  const RingPlace ring = map.ring_of(2 * std::asin(std::sqrt(std::clamp(c.t * map.cap() / 2, 0.0, 1.0))));
  const double turns = c.s - seam.offset() + seam.turns();
  const int sectors = map.grid().sectors;
  const double position = (turns - std::floor(turns)) * sectors;
  const int sector = std::min(static_cast<int>(position), sectors - 1);
  return {ring, {sector, position - sector}, ring.ring};
}

template <class Sampler>
void sample_lights_with(const Sampler& sampler, const PolarMap& radiance,
                        std::span<const RingCoordinates> points, LightArrays& lights) noexcept {
  verify_bug(lights.size() == points.size(), "one light a point");
  const RingDistribution& map = sampler.map();
  const double sector_turns = 1.0 / map.grid().sectors;
  const bool mono = radiance.channels == 1;
  const auto count = static_cast<double>(points.size());
  const auto power = static_cast<float>(map.total_power() / count);
  const Rgb mean = (map.total_illuminance() / count).cast<float>();
  std::array<MapPlace, 32> places;
  for (std::size_t first = 0; first < points.size(); first += places.size()) {
    const std::size_t together = std::min(places.size(), points.size() - first);
    sampler.locate(points.subspan(first, together), std::span(places).first(together));
    for (std::size_t k = 0; k < together; ++k) {
      const MapPlace& place = places[k];
      const std::size_t i = first + k;
      lights.x[i] = static_cast<float>(map.one_minus_cos(place.ring));
      lights.y[i] = static_cast<float>((place.sector.sector + place.sector.fraction) * sector_turns);
      const Rgb colour = mono ? Rgb::Constant(power) : colour_at(radiance, place, mean, power);
      lights.r[i] = colour[0];
      lights.g[i] = colour[1];
      lights.b[i] = colour[2];
    }
  }
  light_kernel::kernels().directions(lights.x.data(), lights.y.data(), lights.z.data(),
                                     static_cast<int>(lights.size()));
  if (mono) return;
  match_total(lights.r, map.total_illuminance()[0]);
  match_total(lights.g, map.total_illuminance()[1]);
  match_total(lights.b, map.total_illuminance()[2]);
}

}  // namespace

template <class Method>
void RingSampler<Method>::locate(std::span<const RingCoordinates> points,
                                 std::span<MapPlace> places) const noexcept {
  if (map_->total_power() > 0)
    light_kernel::kernels().locate(map_->tables(), seam_->tables(), blending(), points.data(),
                                   static_cast<int>(points.size()), places.data());
  else
    for (std::size_t i = 0; i < points.size(); ++i) places[i] = place_on_black(*map_, *seam_, points[i]);
}

template <class Method>
Vec3d RingSampler<Method>::sample(const Vec2d& square) const noexcept {
  const RingCoordinates point = Method::warp(square);
  MapPlace place;
  locate({&point, 1}, {&place, 1});
  return direction_of(map_->one_minus_cos(place.ring), turns_of(place.sector, map_->grid().sectors));
}

template <class Method>
RingBlend RingSampler<Method>::blend_at(const RingPlace& ring) const noexcept {
  return light_kernel::kernels().blend(map_->tables(), blending(), ring);
}

template <class Method>
double RingSampler<Method>::pdf(const Vec3d& direction) const noexcept {
  if (outside(*map_, direction)) return 0;
  const MapCoordinates at = map_coordinates(*map_, direction);
  return density(*map_, at.ring, blend_at(at.ring), at.turns);
}

template <class Method>
Vec2d RingSampler<Method>::invert(const Vec3d& direction) const noexcept {
  const MapCoordinates at = map_coordinates(*map_, direction);
  const RingBlend blend = blend_at(at.ring);
  return Method::unwarp(
      {ring_coordinate(*map_, at.ring), seam_->place(*map_, blend, map_->power_before(blend, at.turns))});
}

template class RingSampler<StandardInversion>;
template class RingSampler<HavranTransform>;

void sample_lights(const StandardInversion& sampler, const PolarMap& radiance,
                   std::span<const RingCoordinates> points, LightArrays& lights) noexcept {
  sample_lights_with(sampler, radiance, points, lights);
}

void sample_lights(const HavranTransform& sampler, const PolarMap& radiance,
                   std::span<const RingCoordinates> points, LightArrays& lights) noexcept {
  sample_lights_with(sampler, radiance, points, lights);
}

}  // namespace lightwell
