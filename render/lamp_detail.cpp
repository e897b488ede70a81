// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/lamp_detail.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "render/lamp_sources.h"

namespace lightwell::render {
namespace {

constexpr std::size_t kPlaces = 256, kLeastOfPrimitive = 4, kMostPrimitives = 512;
constexpr std::size_t kMostLooks = 32768, kLeastLookedAt = 64;

// σ of the light about the middles of its groups, metres.
double spread_of(const LampPlanes& planes, const std::vector<double>& fluxes, const LampGroups& groups) {
  double sum = 0, flux = 0;
  for (int v = 0; v < planes.positions[1]; ++v)
    for (int u = 0; u < planes.positions[0]; ++u) {
      const std::size_t i = planes.image(u, v);
      const double power = std::max(fluxes[i], 0.0);
      sum += power * (planes.position(u, v) - groups.middles[groups.group_of[i]]).squaredNorm();
      flux += power;
    }
  return flux > 0 ? std::sqrt(sum / flux) : 0;
}

// Groups that divide the lamp evenly, from the largest down to none.
std::vector<int> group_sizes(const NearField& lamp) {
  const int all = largest_group(lamp);
  std::vector<int> sizes;
  for (int parts = 1; parts <= all; ++parts)
    if (const int size = (all + parts - 1) / parts; sizes.empty() || size < sizes.back())
      sizes.push_back(size);
  return sizes;
}

struct SeenPlace {
  Vec3d point, normal;  // in the lamp's frame
  double lux = 0;       // of every position
};

// The errors of a lamp's groups where it stands. What all groups are held against is looked up once.
class Errors {
 public:
  Errors(const NearField& lamp, const std::vector<double>& fluxes, double spread_m, const LampStage& stage,
         const Eigen::Isometry3d& world_from_lamp)
      : images_(lamp.intensity), fluxes_(fluxes), spread_m_(spread_m) {
    const Eigen::Isometry3d lamp_from_world = world_from_lamp.inverse();
    const Vec3d eye = lamp_eye(lamp, world_from_lamp);
    const std::size_t count = places_looked_at(stage.places.size(), fluxes.size());
    std::vector<LitPlace> lit;
    for (std::size_t k = 0; k < count; ++k) {
      const Receivers::Place& place = stage.places[k * stage.places.size() / count];
      SeenPlace seen{lamp_from_world * place.point.cast<double>(),
                     lamp_from_world.linear() * place.normal.cast<double>()};
      if (!(seen.point.z() < images_.planes.z_m)) continue;
      const Vec3d way = place.point.cast<double>() - eye;
      LitPlace& by = lit.emplace_back(LitPlace{way.normalized(), way.norm(), 0, place.primitive});
      for_positions([&](int u, int v, std::size_t) {
        const Vec2d from = images_.planes.position(u, v);
        const double candela = candela_from(u, v, from, seen.point);
        by.candela += candela;
        seen.lux += candela * facing(from, seen);
      });
      all_ += seen.lux * seen.lux;
      places_.push_back(seen);
    }
    find_edges(stage.outlines, lit);
  }

  [[nodiscard]] double shadow(int group) const {
    const double spread = spread_of(images_.planes, fluxes_, groups_of(group));
    return spread_m_ > 0 ? spread * std::sqrt(edges_per_m_ / spread_m_) : 0;
  }
  [[nodiscard]] double pattern(int group) const {
    const LampGroups groups = groups_of(group);
    double off = 0;
    for (const SeenPlace& place : places_) {
      double lux = 0;
      for_positions([&](int u, int v, std::size_t i) {
        const Vec2d& from = groups.middles[groups.group_of[i]];
        lux += candela_from(u, v, from, place.point) * facing(from, place);
      });
      off += (lux - place.lux) * (lux - place.lux);
    }
    return all_ > 0 ? std::sqrt(off / all_) : 0;
  }

 private:
  // A place as the lamp's middle sees it.
  struct LitPlace {
    Vec3d direction;
    double distance_m, candela;  // of all positions toward it
    std::size_t primitive;
  };

  template <typename Use>
  void for_positions(const Use& use) const {
    const LampPlanes& planes = images_.planes;
    for (int v = 0; v < planes.positions[1]; ++v)
      for (int u = 0; u < planes.positions[0]; ++u)
        if (const std::size_t i = planes.image(u, v); fluxes_[i] > 0) use(u, v, i);
  }
  // Of a position, as if it stood elsewhere.
  [[nodiscard]] double candela_from(int u, int v, const Vec2d& from, const Vec3d& point) const {
    const LampPlanes& planes = images_.planes;
    const Vec3d way = point - planes.place(from);
    const Vec2d seen = planes.map == LampMap::hemisphere
                           ? square_from_direction(way.normalized())
                           : planes.position(u, v) + way.head<2>() * (planes.distance_m / -way.z());
    return static_cast<double>(luminance(images_.at(u, v, seen)));
  }
  // Lux of a candela.
  [[nodiscard]] double facing(const Vec2d& from, const SeenPlace& place) const {
    const Vec3d way = place.point - images_.planes.place(from);
    const double square = way.squaredNorm();
    return std::abs(way.dot(place.normal)) / (square * std::sqrt(square));
  }
  [[nodiscard]] LampGroups groups_of(int group) const {
    return group_positions(images_.planes, fluxes_, group);
  }

  // Σ of what edges err over Σ of what is shown, a metre of σ.
  void find_edges(std::span<const CasterOutline> outlines, const std::vector<LitPlace>& lit) {
    double off = 0, shown = 0;
    for (const CasterOutline& outline : outlines) {
      // The light that the caster is in, and how far behind it its shadow falls: at the places that its bounds cover, or
      // where none lies there at the nearest to them.
      const double within = std::cos(outline.half_angle_rad);
      double light = 0, lit_places = 0, per_m = 0, behind = 0, nearest_lit = -2, nearest_behind = -2;
      for (const LitPlace& place : lit) {
        const double cosine = std::min(place.direction.dot(outline.direction), within);
        if (cosine >= nearest_lit) {
          if (cosine > nearest_lit) light = lit_places = 0;
          nearest_lit = cosine;
          light += place.candela * place.candela;
          ++lit_places;
        }
        if (place.primitive == outline.primitive || place.distance_m < outline.distance_m ||
            cosine < nearest_behind)
          continue;
        if (cosine > nearest_behind) per_m = behind = 0;
        nearest_behind = cosine;
        per_m += 1 / place.distance_m;
        ++behind;
      }
      if (lit_places == 0 || behind == 0) continue;
      light /= lit_places;
      const double edges = std::max(0.0, outline.rad_per_m - outline.length_rad * per_m / behind);
      off += light * edges * std::sqrt(12.0) / 12;
      if (!(light > 0)) continue;
      const double covered_sr = 2 * kPi * (1 - within);
      const double beam_sr = std::accumulate(fluxes_.begin(), fluxes_.end(), 0.0) / std::sqrt(light);
      shown += light * std::min(4 * covered_sr, std::max(beam_sr - covered_sr, beam_sr / 4));
    }
    edges_per_m_ = shown > 0 ? off / shown : 0;
  }

  const LampImages& images_;
  const std::vector<double>& fluxes_;
  double spread_m_;
  std::vector<SeenPlace> places_;
  double all_ = 0, edges_per_m_ = 0;
};

}  // namespace

Receivers::Receivers(const Scene& scene) {
  std::minstd_rand random(1);
  std::uniform_real_distribution<float> even(0, 1);
  const std::size_t primitives = std::min(scene.primitives.size(), kMostPrimitives);
  if (primitives == 0) return;
  const std::size_t each = std::max(kLeastOfPrimitive, kPlaces / primitives);
  for (std::size_t k = 0; k < primitives; ++k) {
    const Primitive& primitive = scene.primitives[k * scene.primitives.size() / primitives];
    std::vector<double> areas;
    double total = 0;
    for (std::uint32_t i = primitive.first_index; i + 2 < primitive.first_index + primitive.index_count;
         i += 3) {
      const auto corner = [&](std::uint32_t c) -> const Vec3f& {
        return scene.vertices[scene.indices[i + c]].position;
      };
      total += static_cast<double>((corner(1) - corner(0)).cross(corner(2) - corner(0)).norm());
      areas.push_back(total);
    }
    if (!(total > 0)) continue;
    for (std::size_t n = 0; n < each; ++n) {
      const double at =
          (static_cast<double>(n) + static_cast<double>(even(random))) / static_cast<double>(each) * total;
      const auto triangle = std::min(std::upper_bound(areas.begin(), areas.end(), at), areas.end() - 1);
      float a = even(random), b = even(random);
      if (a + b > 1) a = 1 - a, b = 1 - b;
      origins_.push_back({primitive.first_index + 3 * static_cast<std::uint32_t>(triangle - areas.begin()), a,
                          b, k * scene.primitives.size() / primitives});
    }
  }
  move(scene);
}

void Receivers::move(const Scene& scene) {
  places_.clear();
  for (const Origin& origin : origins_) {
    const auto corner = [&](std::uint32_t c) -> const Vec3f& {
      return scene.vertices[scene.indices[origin.first_index + c]].position;
    };
    const Vec3f along = corner(1) - corner(0), across = corner(2) - corner(0);
    const Vec3f normal = along.cross(across);
    if (!(normal.norm() > 0)) continue;
    places_.push_back(
        {corner(0) + origin.a * along + origin.b * across, normal.normalized(), origin.primitive});
  }
}

LampDetail::LampDetail(const NearField& lamp) : fluxes_(position_fluxes(lamp)) {
  const LampPlanes& planes = lamp.intensity.planes;
  spread_m_ = spread_of(planes, fluxes_, group_positions(planes, fluxes_, largest_group(lamp)));
}

double LampDetail::Error::total() const {
  return std::hypot(pattern, shadow);
}

Vec3d lamp_eye(const NearField& lamp, const Eigen::Isometry3d& world_from_lamp) {
  const LampPlanes& planes = lamp.intensity.planes;
  const Vec2d last = planes.position(planes.positions[0] - 1, planes.positions[1] - 1);
  return world_from_lamp * planes.place((planes.first_m + last) / 2);
}

std::size_t places_looked_at(std::size_t places, std::size_t positions) {
  return std::min(places, std::max(kLeastLookedAt, kMostLooks / std::max<std::size_t>(positions, 1)));
}

LampDetail::Error LampDetail::error(const NearField& lamp, int group, const LampStage& stage,
                                    const Eigen::Isometry3d& world_from_lamp) const {
  const Errors errors(lamp, fluxes_, spread_m_, stage, world_from_lamp);
  return {errors.pattern(group), errors.shadow(group)};
}

int LampDetail::choose(const NearField& lamp, double bound, const LampStage& stage,
                       const Eigen::Isometry3d& world_from_lamp, int least, int now) const {
  if (!(bound > 0)) return least;
  const Errors errors(lamp, fluxes_, spread_m_, stage, world_from_lamp);
  const auto too_coarse = [&](int group) {
    const double allowed = now == 0 || group <= now ? bound : bound / 2;
    const double shadow = errors.shadow(group);
    return shadow > allowed || std::hypot(shadow, errors.pattern(group)) > allowed;
  };
  // Smaller groups err less: few of all sizes are looked at. Where that is not so the one found serves all the same.
  std::vector<int> sizes = group_sizes(lamp);
  sizes.erase(std::remove_if(sizes.begin(), sizes.end(), [&](int group) { return group <= least; }),
              sizes.end());
  const auto found = std::partition_point(sizes.begin(), sizes.end(), too_coarse);
  return found == sizes.end() ? least : *found;
}

}  // namespace lightwell::render
