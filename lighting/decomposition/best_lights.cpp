// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/best_lights.h"

#include <algorithm>
#include <cmath>

#include "lighting/decomposition/best/bright_atoms.h"
#include "lighting/decomposition/best/cut_watch.h"
#include "lighting/decomposition/best/error_memory.h"
#include "lighting/decomposition/best/error_prediction.h"
#include "lighting/decomposition/best/light_sizes.h"
#include "lighting/decomposition/best/map_in_parts.h"
#include "lighting/decomposition/best/place_search.h"
#include "lighting/decomposition/best/placed_lights.h"
#include "lighting/decomposition/light_exchange.h"
#include "lighting/decomposition/median_cut.h"
#include "lighting/decomposition/persistent_tree.h"
#include "lighting/decomposition/split_tree.h"

namespace lightwell {
namespace {

// Feedback keeps as much of the last frame's error as costs no more than this share of what all lights are worth.
constexpr double kFeedbackCost = 0.003;
constexpr double kMostFeedback = 0.9;

constexpr double kHysteresis = 0.5;  // a light leaves for what is worth half as much again
constexpr double kThreshold = 1e-5;

constexpr int kImprovements = 5, kPasses = 4, kSteps = 50;

}  // namespace

struct BestLights::State {
  State(const PolarGrid& g, int n, Effort e)
      : grid(g),
        count(n),
        effort(e),
        maker(g, n, e == Effort::frame ? AtomMaker::Detail::frame : AtomMaker::Detail::map),
        atoms(maker.capacity()),
        lights(n),
        powers(n),
        error(n, maker.capacity(), powers.stride() + placement_kernel::kLanes),
        search(n, static_cast<int>(atoms.x.size())),
        exchange(n, PlaceSearch::most_places(n)),
        tree(n),
        cuts(n, atoms.capacity()),
        sizes(n),
        dark{powers.no_dark(), powers.no_dark(), powers.no_dark()},
        luminance_dark(powers.no_dark()) {
    const auto stride = static_cast<std::size_t>(powers.stride()) + placement_kernel::kLanes;
    for (auto* rows : {&power, &potential, &target})
      for (auto& row : *rows) row.assign(stride, 0);
    for (auto* row : {&luminance_power, &still, &moving, &scratch}) row->assign(stride, 0);
    moved.reserve(static_cast<std::size_t>(n));
    place_rest.assign(search.place_points().x.size() + 4, 0);
    predicted.assign(static_cast<std::size_t>(n), 0.0f);
    out.resize(static_cast<std::size_t>(n));
  }

  PolarGrid grid;
  int count;
  Effort effort;

  AtomMaker maker;
  Atoms atoms;
  BrightAtoms bright;
  MomentMatrix atom_moments;  // but for the bright ones'

  PlacedLights lights;
  LightPowers powers;
  ErrorMemory error;
  PlaceSearch search;
  LightExchange exchange;
  PersistentTree tree;
  CutWatch cuts;
  LightSizes sizes;

  bool placed = false;
  bool placed_exactly = false;  // a light an atom: there were no more atoms
  bool stands_dark = false;     // spread out, before any light
  bool looked = false;          // at the atoms' nearest lights, as they stood before this frame's exchanges
  bool settling = false;        // one map until nothing pays any more
  bool grown = false;           // the tree

  std::vector<int> moved;
  std::array<LightPowers::Dark, 3> dark;
  LightPowers::Dark luminance_dark;
  ChannelRows power, potential,
      target;  // a light: its power, error_kernel with the map, and what powers are solved for
  std::vector<double> luminance_power, still, moving, scratch, place_rest;
  Report report;
  std::vector<float> predicted;  // of the first lights up to an entry
  std::vector<DirectionalLight> out;

  void map_potentials(int first, int last) { map_in_parts().potentials(lights, first, last, potential); }
  [[nodiscard]] MapInParts map_in_parts() const { return {atoms, atom_moments, bright}; }

  // Placement works on whole atoms.
  std::vector<Vec3d> find_best_places() {
    bright.give_back(atoms);
    std::vector<Vec3d> found = place_lights(atoms, count, grid.theta_max_rad, effort);
    bright.take(atoms);
    return found;
  }

  void place_at(const std::vector<Vec3d>& found) {
    for (int i = 0; i < count; ++i) lights.set(i, found[static_cast<std::size_t>(i)]);
    sizes.forget();
    powers.place(lights.directions());
    grown = looked = false;
    map_potentials(0, count);
  }

  // With no regard to what was before.
  void start(const std::vector<Vec3d>& found) {
    for (auto& d : dark) d = powers.no_dark();
    luminance_dark = powers.no_dark();
    error.forget();
    place_at(found);
    snap_to_bright();
    placed = true;
    cuts.placed(map_in_parts());
  }

  // Powers of least cost in luminance, and each atom's light.
  void serve_luminance() {
    to_luminance(potential, still, count);
    powers.solve(still, luminance_dark, luminance_power);
    search.look(atoms, lights, settling);
    looked = true;
  }

  // serve_luminance is done.
  [[nodiscard]] CutWatch::Serving serving() const { return {search, still, luminance_power}; }

  void place_anew_after_cut() {
    serve_luminance();
    if (!cuts.is_still_cut(map_in_parts(), serving())) return;
    cuts.weigh(map_in_parts(), serving());
    const std::vector<Vec3d> found = find_best_places();
    if (cuts.is_worth_placing(found, map_in_parts(), serving())) start(found);
  }

  void exchange_lights() {
    exchange.weigh(powers, luminance_power, luminance_dark);
    report.exchanges = 0;
    search.find(atoms, lights);
    const auto places = search.places();
    if (places.empty()) return;
    worth_of_places();
    LightExchange::Options options;
    options.most = std::clamp(2048 / count, 2, std::max(2, count / 4));
    options.hysteresis = kHysteresis;
    options.threshold = kThreshold;
    options.least_distance = 0.1 / std::sqrt(count);
    const auto pairs = exchange.choose(lights.directions(), luminance_power, places, place_rest, options);
    bool sound = true;
    for (const auto& [light, place] : pairs) {
      moved.push_back(light);
      lights.set(light, places[static_cast<std::size_t>(place)]);
      sound = powers.move(light, lights.directions()) && sound;
      map_potentials(light, light + 1);
      error.look_from(lights, light);
    }
    if (!sound) powers.place(lights.directions());  // has not been seen to happen
    report.exchanges = static_cast<int>(pairs.size());
  }

  void worth_of_places() {
    auto at = search.place_points().points();
    at.count = search.place_points().count;
    placement_kernel::kernels().potential(atoms.points(), atoms.luminance.data(), kernel_shares(), at,
                                          place_rest.data());
    const MomentVector mean = map_in_parts().luminance_moments();
    const auto places = search.places();
    for (std::size_t c = 0; c < places.size(); ++c)
      place_rest[c] += moment_weight() * lambertian_moments(places[c]).dot(mean);
  }

  // As much of the last error as costs little beside what the lights are worth where they stand now.
  void bound_feedback() {
    report.feedback = 0;
    if (error.empty()) return;
    to_luminance(potential, still, count);
    powers.solve(still, luminance_dark, luminance_power);
    to_luminance(error.at_lights(), moving, count);
    powers.multiply_by_inverse(moving, scratch);
    double worth = 0, cost = 0;
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      worth += luminance_power[k] * luminance_power[k] / powers.inverse_diagonal(i);
      cost += moving[k] * scratch[k];
    }
    report.feedback =
        cost > 0 ? std::min(kMostFeedback, std::sqrt(kFeedbackCost * worth / cost)) : kMostFeedback;
  }

  void solve_powers() {
    for (std::size_t c = 0; c < 3; ++c) {
      const double total = atoms.total[static_cast<Eigen::Index>(c)] / atoms.scale;
      if (!(total > 0)) {
        std::fill(power[c].begin(), power[c].end(), 0.0);
        continue;
      }
      const auto& last = error.at_lights()[c];
      for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k)
        target[c][k] = potential[c][k] + (report.feedback > 0 ? report.feedback * last[k] : 0);
      powers.solve(target[c], dark[c], power[c]);
      double sum = 0;
      for (int i = 0; i < count; ++i) sum += power[c][static_cast<std::size_t>(i)];
      for (int i = 0; i < count; ++i)
        power[c][static_cast<std::size_t>(i)] =
            sum > 0 ? power[c][static_cast<std::size_t>(i)] * (total / sum) : total / count;
    }
  }

  void show() {
    bright.give_back(atoms);
    error.keep({atoms, map_in_parts().moments(), lights, powers, power, potential});
    write_out();
  }

  void write_out() {
    to_luminance(power, luminance_power, count);
    const PersistentTree::Lights now{lights.directions(), luminance_power, powers.matrix(), powers.stride()};
    if (grown)
      tree.follow(now, moved);
    else
      tree.build(now);
    grown = true;
    if (!looked) search.look(atoms, lights, true);
    sizes.follow(atoms, search, lights, looked ? std::span<const int>(moved) : std::span<const int>());
    looked = false;
    const double cost = search.cell_cost(atoms, luminance_power);
    cuts.shown(cost);
    predict_errors(atoms, cost, tree.costs(), predicted);
    const auto entries = tree.order();
    for (std::size_t k = 0; k < entries.size(); ++k) {
      const int i = entries[k].light;
      DirectionalLight& light = out[k];
      light.direction = lights.direction(i).cast<float>().normalized();
      for (std::size_t c = 0; c < 3; ++c)
        light.illuminance[static_cast<Eigen::Index>(c)] =
            static_cast<float>(power[c][static_cast<std::size_t>(i)] * atoms.scale);
      light.id = lights.id(i);
      light.parent = entries[k].parent;
      light.predicted_error = predicted[k];
      light.angular_radius_rad = sizes.radius_rad(i);
    }
  }

  // Of the map of the last frame: exchanges until none pays, then all lights down to the nearest places of least cost.
  void improve() {
    settling = true;
    bright.take(atoms);
    for (int round = 0; round < kImprovements; ++round) {
      for (int pass = 0; pass < kPasses; ++pass) {
        error.forget();
        serve_luminance();
        exchange_lights();
        if (report.exchanges == 0) break;
      }
      if (round + 1 < kImprovements)
        place_at(descend_lights(atoms, lights.directions(), grid.theta_max_rad, kSteps));
    }
    snap_to_bright();
    sizes.forget();
    looked = false;
    settling = false;
    grown = false;
    solve_powers();
    show();
  }

  // A descent's last steps are long beside what a sun forgives: a light this near to a bright atom is meant for it.
  void snap_to_bright() {
    bool any = false;
    for (const BrightAtoms::Bright& b : bright.all()) {
      const int nearest = lights.nearest_to(b.direction);
      const double away = (lights.direction(nearest) - b.direction).norm();
      const double reach = luminance(b.weight) > 0.5 ? 0.0175 : 0.0035;  // 1°, 0.2°
      if (away == 0 || away > reach) continue;
      lights.set(nearest, b.direction);
      any = true;
    }
    if (!any) return;
    powers.place(lights.directions());
    map_potentials(0, count);
  }

  // Atoms as they are, one light each.
  void show_all_atoms() {
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const bool lit = i < atoms.count;
      const Vec3d d = lit ? atoms.direction(i) : atoms.direction(0);
      if (!placed_exactly || lights.direction(i) != d) lights.set(i, d);
      const Rgbd w = lit ? atoms.weight_of(i) : Rgbd::Zero();
      for (std::size_t c = 0; c < 3; ++c) power[c][k] = w[static_cast<Eigen::Index>(c)];
    }
    for (std::size_t c = 0; c < 3; ++c) {
      double sum = 0;
      for (int i = 0; i < count; ++i) sum += power[c][static_cast<std::size_t>(i)];
      const double total = atoms.total[static_cast<Eigen::Index>(c)] / atoms.scale;
      for (int i = 0; i < count && sum > 0; ++i) power[c][static_cast<std::size_t>(i)] *= total / sum;
    }
    placed_exactly = true;
    placed = grown = false;
    error.forget();
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      out[k] = {lights.direction(i).cast<float>().normalized(), Rgb::Zero(), -1, lights.id(i)};
      for (std::size_t c = 0; c < 3; ++c)
        out[k].illuminance[static_cast<Eigen::Index>(c)] = static_cast<float>(power[c][k] * atoms.scale);
      SecondMoment of_atom;
      if (i < atoms.count)
        of_atom.add(static_cast<double>(atoms.luminance[k]), static_cast<double>(atoms.solid_angle_sr[k]), 0);
      out[k].angular_radius_rad = of_atom.disc_radius_rad();
    }
    out = progressive_order(out);
  }

  void process(const PolarMap& map) {
    maker.make(map, atoms);
    report = {};
    moved.clear();
    if (!(atoms.scale > 0)) {
      show_black();
      return;
    }
    if (atoms.count <= count) {
      show_all_atoms();
      return;
    }
    placed_exactly = stands_dark = false;
    bright.take(atoms);
    atom_moments.setZero();
    placement_kernel::kernels().add_moments(atoms.points(), atoms.weights().data(), atom_moments.data());
    const bool first = !placed;
    if (first) {
      start(find_best_places());
    } else {
      error.scale_to(atoms);
      map_potentials(0, count);
      serve_luminance();
      const bool may_be_cut = cuts.may_be_cut(map_in_parts(), serving());
      exchange_lights();
      if (may_be_cut) place_anew_after_cut();
    }
    bound_feedback();
    solve_powers();
    show();
    if (first && effort == Effort::thorough) improve();
  }

  void show_black() {
    for (DirectionalLight& light : out) {
      light.illuminance = Rgb::Zero();
      light.predicted_error = 0;
    }
    if (!placed && !placed_exactly && !stands_dark) stand_dark();
    error.forget();
  }

  // Before any light: a tree of lights spread over the cap, all dark.
  void stand_dark() {
    stands_dark = true;
    const double reach = 1 - std::cos(std::min(grid.theta_max_rad, kPi));
    for (int i = 0; i < count; ++i) {
      const double y = 1 - (i + 0.5) / count * reach;
      lights.set(i, direction_from_spherical({std::acos(std::clamp(y, -1.0, 1.0)), 2.399963 * i}));
    }
    for (auto& row : power) std::fill(row.begin(), row.end(), 0.0);
    powers.place(lights.directions());
    grown = false;
    write_out();
    grown = false;
  }
};

BestLights::BestLights(const PolarGrid& grid, int count, Effort first)
    : state_(std::make_unique<State>(grid, count, first)) {}
BestLights::BestLights(BestLights&&) noexcept = default;
BestLights& BestLights::operator=(BestLights&&) noexcept = default;
BestLights::~BestLights() = default;

std::span<const DirectionalLight> BestLights::process(const PolarMap& map) {
  state_->process(map);
  return state_->out;
}

void BestLights::reset() noexcept {
  // Places are kept: from them exchange finds the way to any map, and a frame after a gap costs what any other does.
  state_->error.forget();
}

Rgbd BestLights::total_illuminance() const noexcept {
  return state_->atoms.total;
}

BestLights::Report BestLights::report() const noexcept {
  return state_->report;
}

std::vector<DirectionalLight> best_lights(const PolarMap& map, int count) {
  if (count > kMostPlacedLights) return median_cut(map, count);
  BestLights lights(map.grid, count, Effort::thorough);
  const auto out = lights.process(map);
  std::vector<DirectionalLight> set(out.begin(), out.end());
  for (DirectionalLight& light : set) light.id = 0;  // no frame follows in which it could be the same light
  return set;
}

}  // namespace lightwell
