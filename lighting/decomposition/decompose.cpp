// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/decompose.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "lighting/decomposition/angular_radius.h"
#include "lighting/decomposition/best_lights.h"
#include "lighting/decomposition/cell_powers.h"
#include "lighting/decomposition/kollig_keller.h"
#include "lighting/decomposition/light_tree.h"
#include "lighting/decomposition/median_cut.h"
#include "lighting/decomposition/penrose_sampling.h"
#include "lighting/decomposition/structured_sampling.h"
#include "lighting/decomposition/uniform_lights.h"

namespace lightwell {
namespace {

using Lights = std::vector<DirectionalLight>;

// What makes the first n lights a good set by themselves, where the method's own powers are kept.
enum class Order {
  sequence,  // all lights are alike: the rest's power goes to them in proportion
  parents,   // the method's own tree
  none,      // the lights are made into one (lighting/decomposition/light_tree.h)
};

struct Entry {
  Method method;
  std::string_view name;
  Order order;
  Lights (*lights)(const PolarMap&, int, const DecomposeOptions&);
};

constexpr std::array kEntries = {
    Entry{Method::best, "best", Order::parents,
          [](const PolarMap& map, int count, const DecomposeOptions&) { return best_lights(map, count); }},
    Entry{Method::standard, "standard", Order::sequence,
          [](const PolarMap& map, int count, const DecomposeOptions& o) {
            return standard_lights(map, count, *o.points, o.seed);
          }},
    Entry{Method::havran, "havran", Order::sequence,
          [](const PolarMap& map, int count, const DecomposeOptions& o) {
            return havran_lights(map, count, *o.points, *o.interpolation, o.seed);
          }},
    Entry{Method::structured, "structured", Order::none,
          [](const PolarMap& map, int count, const DecomposeOptions&) {
            return structured_sampling(map, count);
          }},
    Entry{Method::kollig_keller, "kollig-keller", Order::none,
          [](const PolarMap& map, int count, const DecomposeOptions&) { return kollig_keller(map, count); }},
    Entry{Method::penrose, "penrose", Order::sequence,
          [](const PolarMap& map, int count, const DecomposeOptions& o) {
            return penrose_sampling(map, count, o.seed);
          }},
    Entry{Method::median_cut, "median-cut", Order::parents,
          [](const PolarMap& map, int count, const DecomposeOptions&) { return median_cut(map, count); }},
    Entry{Method::uniform, "uniform", Order::none,
          [](const PolarMap& map, int count, const DecomposeOptions& o) {
            return uniform_lights(map, count, o.seed);
          }},
};

constexpr bool every_method_has_its_row() {
  if (kEntries.size() != kMethods.size()) return false;
  for (std::size_t i = 0; i < kEntries.size(); ++i)
    if (kEntries[i].method != kMethods[i]) return false;
  return true;
}
static_assert(every_method_has_its_row());

const Entry& entry(Method method) {
  return kEntries[static_cast<std::size_t>(method)];
}

Order order_of(Order own, Powers powers) {
  if (powers == Powers::own || (own == Order::sequence && powers == Powers::equal)) return own;
  return Order::none;
}

// The points a method can take, its own first.
std::span<const Points> points_of(Method method) {
  static constexpr std::array kStandard = {Points::halton, Points::random};
  static constexpr std::array kHavran = {Points::relaxed, Points::halton};
  if (method == Method::standard) return kStandard;
  if (method == Method::havran) return kHavran;
  return {};
}

constexpr std::array<std::string_view, 4> kPowersNames = {"own", "cells", "means", "equal"};
constexpr std::array<std::string_view, 3> kPointsNames = {"random", "halton", "relaxed"};
constexpr std::array<std::string_view, 2> kInterpolationNames = {"power", "printed"};

template <class Enum, std::size_t kCount>
std::optional<Enum> from_name(const std::array<std::string_view, kCount>& names, std::string_view wanted) {
  const auto found = std::find(names.begin(), names.end(), wanted);
  if (found == names.end()) return std::nullopt;
  return static_cast<Enum>(found - names.begin());
}

bool sound(float radiance) {
  return radiance >= 0 && radiance <= std::numeric_limits<float>::max();
}

bool sound(const PolarMap& map) {
  std::size_t unsound = 0;  // counted without leaving early: a loop of vectors
  for (const float radiance : map.radiance) unsound += sound(radiance) ? 0 : 1;
  return unsound == 0;
}

PolarMap with_unsound_as_zero(PolarMap map) {
  for (float& radiance : map.radiance)
    if (!sound(radiance)) radiance = 0;
  return map;
}

// The mean of places beyond the horizon may lie outside of the map: raised to its edge.
void keep_inside(const PolarGrid& grid, Lights& lights) {
  const double edge = std::cos(grid.theta_max_rad);
  for (DirectionalLight& light : lights) {
    if (static_cast<double>(light.direction.y()) >= edge) continue;
    const double lambda = spherical_from_direction(light.direction.cast<double>()).lambda_rad;
    light.direction = direction_from_spherical({grid.theta_max_rad, lambda}).cast<float>();
  }
}

}  // namespace

std::string_view name(Method method) {
  return entry(method).name;
}

std::optional<Method> method_from_name(std::string_view wanted) {
  for (const Entry& e : kEntries)
    if (e.name == wanted) return e.method;
  return std::nullopt;
}

std::string method_names() {
  std::string names;
  for (const Entry& e : kEntries) names += (names.empty() ? "" : ", ") + std::string(e.name);
  return names;
}

std::string_view name(Powers powers) {
  return kPowersNames[static_cast<std::size_t>(powers)];
}
std::string_view name(Points points) {
  return kPointsNames[static_cast<std::size_t>(points)];
}
std::string_view name(Interpolation interpolation) {
  return kInterpolationNames[static_cast<std::size_t>(interpolation)];
}
std::optional<Powers> powers_from_name(std::string_view wanted) {
  return from_name<Powers>(kPowersNames, wanted);
}
std::optional<Points> points_from_name(std::string_view wanted) {
  return from_name<Points>(kPointsNames, wanted);
}
std::optional<Interpolation> interpolation_from_name(std::string_view wanted) {
  return from_name<Interpolation>(kInterpolationNames, wanted);
}

Coverage coverage_of(const PolarGrid& grid) {
  return grid.theta_max_rad > 0.75 * kPi ? Coverage::sphere : Coverage::hemisphere;
}

std::optional<LightPipelineOptions::Sampler> sampler_of(Method method) {
  if (method == Method::standard) return LightPipelineOptions::Sampler::standard;
  if (method == Method::havran) return LightPipelineOptions::Sampler::havran;
  return std::nullopt;
}

Result<DecomposeOptions> resolved(Method method, const DecomposeOptions& options) {
  DecomposeOptions all = options;
  const auto allowed = points_of(method);
  if (!allowed.empty() && !all.points) all.points = allowed.front();
  if (all.points && std::find(allowed.begin(), allowed.end(), *all.points) == allowed.end())
    return Error{ErrorKind::usage,
                 "points " + std::string(name(*all.points)) + " do not apply to method " +
                     std::string(name(method)) +
                     ", allowed: halton, random with standard; relaxed, halton with havran"};
  if (method == Method::havran && !all.interpolation) all.interpolation = Interpolation::power;
  if (all.interpolation && method != Method::havran)
    return Error{ErrorKind::usage, "interpolation " + std::string(name(*all.interpolation)) +
                                       " does not apply to method " + std::string(name(method)) +
                                       ", allowed: with havran"};
  return all;
}

Result<LightSet> decompose(const PolarMap& map, Method method, int count, const DecomposeOptions& options) {
  if (count < 1 || count > kMostLights)
    return Error{ErrorKind::usage,
                 "count is " + std::to_string(count) + ", allowed 1 to " + std::to_string(kMostLights)};
  const auto all = resolved(method, options);
  if (!all) return all.error();
  if (!sound(map)) return decompose(with_unsound_as_zero(map), method, count, options);
  const Rgbd total = total_illuminance(map);
  if (!(total.maxCoeff() <= static_cast<double>(std::numeric_limits<float>::max())))
    return Error{ErrorKind::bad_input, "total illuminance is beyond a 32 bit float (3.4e38 lux)"};
  LightSet set;
  set.method = name(method);
  set.coverage = coverage_of(map.grid);
  set.total_illuminance = total.cast<float>();
  set.lights = entry(method).lights(map, count, *all);
  if (all->powers == Powers::means) set_cell_means(map, set.lights);
  keep_inside(map.grid, set.lights);
  if (all->powers == Powers::cells) set_cell_powers(map, set.lights);
  if (all->powers == Powers::equal) set_equal_powers(map, set.lights);
  set_angular_radii(map, set.lights);
  const Order order = order_of(entry(method).order, all->powers);
  set.has_parents = order != Order::sequence;
  if (order == Order::none) set.lights = as_tree(set.lights);
  return set;
}

Result<LightSet> decompose(const PolarMap& map, Method method, int count, std::uint32_t seed) {
  DecomposeOptions options;
  options.seed = seed;
  return decompose(map, method, count, options);
}

}  // namespace lightwell
