// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/ring_sampling.h"

#include <algorithm>
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

RingPlace ring_at(const RingDistribution& map, double t) noexcept {
  if (map.total_power() > 0) return map.ring_at(t);
  // Black: uniform in solid angle over the cap.
  return map.ring_of(2 * std::asin(std::sqrt(std::clamp(t * map.cap() / 2, 0.0, 1.0))));
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

// The blend that stands for "every azimuth alike".
RingBlend even_blend(int ring) {
  return {ring, ring, 0, 0, 1};
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

// Sine and cosine of a part of a turn in [0, 1], branch-free so that the compiler makes vectors of it.
// Taylor polynomials on an eighth of a turn either side: error < 4e-8, float's own.
inline void sine_cosine(float turns, float& sine, float& cosine) {
  const int quadrant = static_cast<int>(turns * 4 + 0.5f);
  const float x = (turns - 0.25f * static_cast<float>(quadrant)) * static_cast<float>(2 * kPi);
  const float q = x * x;
  const float sx = x * (1 + q * (-1.0f / 6 + q * (1.0f / 120 + q * (-1.0f / 5040))));
  const float cx = 1 + q * (-0.5f + q * (1.0f / 24 + q * (-1.0f / 720 + q * (1.0f / 40320))));
  const bool swap = (quadrant & 1) != 0;
  const float s = swap ? cx : sx;
  const float c = swap ? sx : cx;
  sine = (quadrant & 2) != 0 ? -s : s;
  cosine = ((quadrant + 1) & 2) != 0 ? -c : c;
}

// height (1 − cos θ) and turns in x and y become directions.
void directions_from_places(LightArrays& lights) noexcept {
  float* __restrict x = lights.x.data();
  float* __restrict y = lights.y.data();
  float* __restrict z = lights.z.data();
  const std::size_t count = lights.size();
  for (std::size_t i = 0; i < count; ++i) {
    const float height = x[i];
    float sine = 0, cosine = 0;
    sine_cosine(y[i], sine, cosine);
    const float sin_theta = std::sqrt(std::max(0.0f, height * (2 - height)));
    x[i] = sin_theta * sine;
    y[i] = 1 - height;
    z[i] = sin_theta * cosine;
  }
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

// Steps of several lights side by side: where, then which azimuths, then which sectors.
template <class BlendAt>
void locate_together(const RingDistribution& map, const AzimuthSeam& seam, const RingCoordinates* c,
                     BlendAt blend_at, MapPlaces& places) noexcept {
  constexpr std::size_t kCount = RingDistribution::kTogether;
  std::array<double, kCount> t, target;
  std::array<RingPlace, kCount> rings;
  std::array<RingBlend, kCount> blends;
  std::array<SectorPlace, kCount> sectors;
  for (std::size_t i = 0; i < kCount; ++i) t[i] = c[i].t;
  if (map.total_power() > 0)
    map.rings_at(t, rings);
  else
    for (std::size_t i = 0; i < kCount; ++i) rings[i] = ring_at(map, t[i]);
  for (std::size_t i = 0; i < kCount; ++i) {
    blends[i] = blend_at(rings[i]);
    target[i] = seam.power_target(map, blends[i], c[i].s);
  }
  map.sectors_at(blends, target, sectors);
  for (std::size_t i = 0; i < kCount; ++i) places[i] = {rings[i], sectors[i], blends[i]};
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
    colour = map.rgb(bin_in(place.blend.b));
    y = luminance(colour);
  }
  return y > 0 ? Rgb(colour * (power / y)) : mean;
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
  const auto put = [&](std::size_t i, const MapPlace& place) {
    lights.x[i] = static_cast<float>(map.one_minus_cos(place.ring));
    lights.y[i] = static_cast<float>((place.sector.sector + place.sector.fraction) * sector_turns);
    if (mono) return;
    const Rgb colour = colour_at(radiance, place, mean, power);
    lights.r[i] = colour[0];
    lights.g[i] = colour[1];
    lights.b[i] = colour[2];
  };
  constexpr std::size_t kTogether = RingDistribution::kTogether;
  MapPlaces places;
  std::size_t i = 0;
  for (; i + kTogether <= points.size(); i += kTogether) {
    sampler.locate(points.data() + i, places);
    for (std::size_t k = 0; k < kTogether; ++k) put(i + k, places[k]);
  }
  for (; i < points.size(); ++i) put(i, sampler.locate(points[i]));
  directions_from_places(lights);
  if (mono) {
    std::fill(lights.r.begin(), lights.r.end(), power);
    std::fill(lights.g.begin(), lights.g.end(), power);
    std::fill(lights.b.begin(), lights.b.end(), power);
    return;
  }
  match_total(lights.r, map.total_illuminance()[0]);
  match_total(lights.g, map.total_illuminance()[1]);
  match_total(lights.b, map.total_illuminance()[2]);
}

}  // namespace

RingBlend StandardInversion::blend_at(const RingPlace& place) const noexcept {
  if (map_->ring_power(place.ring) <= 0) return even_blend(place.ring);
  return {place.ring, place.ring, 1, 0, 0};
}

MapPlace StandardInversion::locate(const RingCoordinates& c) const noexcept {
  const RingPlace ring = ring_at(*map_, c.t);
  const RingBlend blend = blend_at(ring);
  return {ring, map_->sector_at(blend, seam_->power_target(*map_, blend, c.s)), blend};
}

void StandardInversion::locate(const RingCoordinates* c, MapPlaces& places) const noexcept {
  locate_together(
      *map_, *seam_, c, [this](const RingPlace& ring) { return blend_at(ring); }, places);
}

Vec3d StandardInversion::sample(const Vec2d& square) const noexcept {
  const MapPlace place = locate(warp(square));
  return direction_of(map_->one_minus_cos(place.ring), turns_of(place.sector, map_->grid().sectors));
}

double StandardInversion::pdf(const Vec3d& direction) const noexcept {
  if (outside(*map_, direction)) return 0;
  const MapCoordinates at = map_coordinates(*map_, direction);
  return density(*map_, at.ring, blend_at(at.ring), at.turns);
}

Vec2d StandardInversion::invert(const Vec3d& direction) const noexcept {
  const MapCoordinates at = map_coordinates(*map_, direction);
  const RingBlend blend = blend_at(at.ring);
  return {ring_coordinate(*map_, at.ring), seam_->place(*map_, blend, map_->power_before(blend, at.turns))};
}

RingBlend HavranTransform::blend_at(const RingPlace& place) const noexcept {
  // Distance from the middle of the ring, and the ring on that side (none beyond the zenith and the edge).
  const double away = place.fraction - 0.5;
  const int side = std::clamp(place.ring + (away < 0 ? -1 : 1), 0, map_->grid().rings - 1);
  const double weight = side == place.ring ? 0 : std::abs(away);
  RingBlend blend{place.ring, side, 1 - weight, weight, 0};
  if (interpolation_ == Interpolation::by_power) {
    if (map_->power(blend) <= 0) return even_blend(place.ring);
    return blend;
  }
  // Each ring's distribution normalised; a black ring's is even.
  const double own = map_->ring_power(blend.a);
  const double other = map_->ring_power(blend.b);
  const int sectors = map_->grid().sectors;
  blend.uniform = ((own > 0 ? 0 : blend.weight_a) + (other > 0 ? 0 : blend.weight_b)) / sectors;
  blend.weight_a = own > 0 ? blend.weight_a / own : 0;
  blend.weight_b = other > 0 ? blend.weight_b / other : 0;
  return blend;
}

MapPlace HavranTransform::locate(const RingCoordinates& c) const noexcept {
  const RingPlace ring = ring_at(*map_, c.t);
  const RingBlend blend = blend_at(ring);
  return {ring, map_->sector_at(blend, seam_->power_target(*map_, blend, c.s)), blend};
}

void HavranTransform::locate(const RingCoordinates* c, MapPlaces& places) const noexcept {
  locate_together(
      *map_, *seam_, c, [this](const RingPlace& ring) { return blend_at(ring); }, places);
}

Vec3d HavranTransform::sample(const Vec2d& square) const noexcept {
  const MapPlace place = locate(warp(square));
  return direction_of(map_->one_minus_cos(place.ring), turns_of(place.sector, map_->grid().sectors));
}

double HavranTransform::pdf(const Vec3d& direction) const noexcept {
  if (outside(*map_, direction)) return 0;
  const MapCoordinates at = map_coordinates(*map_, direction);
  return density(*map_, at.ring, blend_at(at.ring), at.turns);
}

Vec2d HavranTransform::invert(const Vec3d& direction) const noexcept {
  const MapCoordinates at = map_coordinates(*map_, direction);
  const RingBlend blend = blend_at(at.ring);
  return square_from_disc(
      {ring_coordinate(*map_, at.ring), seam_->place(*map_, blend, map_->power_before(blend, at.turns))});
}

void sample_lights(const StandardInversion& sampler, const PolarMap& radiance,
                   std::span<const RingCoordinates> points, LightArrays& lights) noexcept {
  sample_lights_with(sampler, radiance, points, lights);
}

void sample_lights(const HavranTransform& sampler, const PolarMap& radiance,
                   std::span<const RingCoordinates> points, LightArrays& lights) noexcept {
  sample_lights_with(sampler, radiance, points, lights);
}

}  // namespace lightwell
