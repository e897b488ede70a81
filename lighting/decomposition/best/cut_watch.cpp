// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/best/cut_watch.h"

#include <algorithm>

namespace lightwell {
namespace {

// Where the cost has doubled, and exchange has not mended it, lights are placed as if there had been none, and taken if
// they cost so much less.
constexpr double kStale = 2;
constexpr double kStillStale = 1.3;  // after exchange
constexpr double kWorthACut = 0.7;
constexpr double kCostForgotten = 0.99;     // a frame: what it may double from
constexpr int kMostLightsPlacedAnew = 256;  // they take 60 ms, more much longer

// Few lights miss so much of any map that the cost says little of a change. The map's Lambertian moments do: where they
// have changed by so much, other places are tried, and to take them it needs a cut or half of the cost.
constexpr int kFewLights = 8;
constexpr double kOtherMoments = 0.05;
constexpr double kCutMoments = 0.3;
constexpr double kWorthAPop = 0.5;

}  // namespace

CutWatch::CutWatch(int lights, int atoms) : count_(lights), atoms_(atoms) {
  if (lights <= kFewLights) at_atoms_.assign(static_cast<std::size_t>(atoms) + placement_kernel::kLanes, 0);
}

void CutWatch::placed(const MapInParts& map) noexcept {
  cost_to_double_ = 0;
  placed_moments_ = map.luminance_moments();
}

void CutWatch::shown(double cell_cost) noexcept {
  cost_to_double_ = std::max(cell_cost, kCostForgotten * cost_to_double_);
}

// Of the atoms' luminance among themselves: Σ atom · atom · k.
double CutWatch::own_of_atoms(const MapInParts& map) {
  const Atoms& atoms = map.atoms;
  auto at = atoms.points();
  at.count = atoms.count;
  placement_kernel::kernels().potential(atoms.points(), atoms.luminance.data(), kernel_shares(), at,
                                        at_atoms_.data());
  double own = moment_weight() * map.luminance_moments().squaredNorm();
  for (std::size_t k = 0; k < static_cast<std::size_t>(atoms.count); ++k)
    own += static_cast<double>(atoms.luminance[k]) * at_atoms_[k];
  return own;
}

// What lights leave to be shown wrongly. Of few lights twice the cost itself, own − Σ power · b; of many that is lost in
// rounding, and is told by how far atoms are from their lights.
double CutWatch::left_wrong(const MapInParts& map, const Serving& lights) const {
  if (count_ > kFewLights) return lights.search.cell_cost(map.atoms, lights.power);
  double left = own_;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count_); ++i)
    left -= lights.power[i] * lights.potential[i];
  return left;
}

// row: of a row of values of the lights, as the kernels want it
double CutWatch::left_wrong_at(const std::vector<Vec3d>& places, const MapInParts& map,
                               std::size_t row) const {
  PlacedLights there(count_);
  for (int i = 0; i < count_; ++i) there.set(i, places[static_cast<std::size_t>(i)]);
  LightPowers powers(count_);
  powers.place(there.directions());
  ChannelRows worth;
  for (auto& channel : worth) channel.assign(row, 0);
  map.potentials(there, 0, count_, worth);
  std::vector<double> potential(row, 0), power(row, 0);
  to_luminance(worth, potential, count_);
  LightPowers::Dark none = powers.no_dark();
  powers.solve(potential, none, power);
  PlaceSearch search(count_, atoms_);
  search.look(map.atoms, there, true);
  return left_wrong(map, {search, potential, power});
}

// Relative, since lights were placed or other places were last refused.
double CutWatch::change_of_moments(const MapInParts& map) const {
  const double before = placed_moments_.norm();
  return before > 0 ? (map.luminance_moments() - placed_moments_).norm() / before : 1;
}

bool CutWatch::looks_cut(const MapInParts& map, const Serving& now, double times) const {
  if (count_ > kMostLightsPlacedAnew) return false;
  if (count_ <= kFewLights) return change_of_moments(map) > kOtherMoments;
  return now.search.cell_cost(map.atoms, now.power) > times * cost_to_double_;
}

bool CutWatch::may_be_cut(const MapInParts& map, const Serving& now) const {
  return looks_cut(map, now, kStale);
}
bool CutWatch::is_still_cut(const MapInParts& map, const Serving& now) const {
  return looks_cut(map, now, kStillStale);
}

void CutWatch::weigh(const MapInParts& map, const Serving& now) {
  own_ = count_ <= kFewLights ? own_of_atoms(map) : 0;
  cost_ = left_wrong(map, now);
}

bool CutWatch::is_worth_placing(const std::vector<Vec3d>& found, const MapInParts& map, const Serving& now) {
  const bool small_change = count_ <= kFewLights && change_of_moments(map) < kCutMoments;
  const double worth = small_change ? kWorthAPop : kWorthACut;
  if (left_wrong_at(found, map, now.power.size()) < worth * cost_) return true;
  cost_to_double_ = cost_;
  placed_moments_ = map.luminance_moments();
  return false;
}

}  // namespace lightwell
