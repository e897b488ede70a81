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
      origins_.push_back(
          {primitive.first_index + 3 * static_cast<std::uint32_t>(triangle - areas.begin()), a, b});
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
    places_.push_back({corner(0) + origin.a * along + origin.b * across, normal.normalized()});
  }
}

LampDetail::LampDetail(const NearField& lamp) : fluxes_(position_fluxes(lamp)) {
  const LampPlanes& planes = lamp.intensity.planes;
  spread_m_ = spread_of(planes, fluxes_, group_positions(planes, fluxes_, largest_group(lamp)));
}

double LampDetail::Error::total() const {
  return std::hypot(pattern, shadow);
}

LampDetail::Error LampDetail::error(const NearField& lamp, int group,
                                    std::span<const Receivers::Place> places, const Sphere& objects,
                                    const Eigen::Isometry3d& world_from_lamp) const {
  const LampPlanes& planes = lamp.intensity.planes;
  const LampGroups groups = group_positions(planes, fluxes_, group);
  const Eigen::Isometry3d lamp_from_world = world_from_lamp.inverse();
  double off = 0, all = 0;
  for (const Receivers::Place& place : places) {
    const Vec3d point = lamp_from_world * place.point.cast<double>();
    const Vec3d normal = lamp_from_world.linear() * place.normal.cast<double>();
    if (!(point.z() < planes.z_m)) continue;
    double exact = 0, together = 0;
    for (int v = 0; v < planes.positions[1]; ++v)
      for (int u = 0; u < planes.positions[0]; ++u) {
        const std::size_t i = planes.image(u, v);
        if (!(fluxes_[i] > 0)) continue;
        const auto lux_from = [&](const Vec2d& from) {
          const Vec3d way = point - planes.place(from);
          const double square = way.squaredNorm();
          const Vec2d seen = planes.map == LampMap::hemisphere
                                 ? square_from_direction(way.normalized())
                                 : planes.position(u, v) + way.head<2>() * (planes.distance_m / -way.z());
          return luminance(lamp.intensity.at(u, v, seen)) * std::abs(way.dot(normal)) /
                 (square * std::sqrt(square));
        };
        exact += lux_from(planes.position(u, v));
        together += lux_from(groups.middles[groups.group_of[i]]);
      }
    off += (together - exact) * (together - exact);
    all += exact * exact;
  }
  Error error;
  error.pattern = all > 0 ? std::sqrt(off / all) : 0;
  if (spread_m_ > 0 && objects.radius > 0) {
    const auto radius = static_cast<double>(objects.radius);
    const double away = (world_from_lamp.translation() - objects.centre.cast<double>()).norm() - radius;
    const double spread = spread_of(planes, fluxes_, groups);
    const double edge = spread * radius / std::max(away, radius / 4);
    // √12 σ is the ramp's width; of all of the lamp's ramp only the groups' steps are left.
    error.shadow = std::sqrt(std::sqrt(12.0) / 12 * edge * (spread / spread_m_) / (2 * radius));
  }
  return error;
}

int LampDetail::choose(const NearField& lamp, double bound, std::span<const Receivers::Place> places,
                       const Sphere& objects, const Eigen::Isometry3d& world_from_lamp, int least,
                       int now) const {
  if (!(bound > 0)) return least;
  const auto within = [&](int group, double share) {
    return error(lamp, group, places, objects, world_from_lamp).total() <= share * bound;
  };
  for (const int group : group_sizes(lamp)) {
    if (group <= least) break;
    if (group == now ? within(group, 1) : within(group, now == 0 || group < now ? 1 : 0.5)) return group;
  }
  return least;
}

}  // namespace lightwell::render
