// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/best_lights.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

// Shadow error predicted: kErrorOfCost · √(kOwnErrorOfCells · Σ atom · its light · their distance + what folding costs) /
// light on the ground. Fitted on 29 captured maps, 1 to 128 lights: the ratio to the measured error has a spread (one
// sigma) of a quarter, 95 % lie within a factor of 1.6.
constexpr double kErrorOfCost = 0.34;
constexpr double kOwnErrorOfCells = 0.17;

constexpr int kAllAtomsUpTo = 128;  // lights

// A place nearer to a light than this is that light's.
constexpr float kLeastDistance = 0.0035f;  // 0.2°

constexpr int kImprovements = 5, kPasses = 4, kSteps = 50;
int candidates_for(int count) {
  return count <= 128 ? std::clamp(count, 16, 64) : 32;
}

using Rows = std::array<std::vector<double>, 3>;

// An atom with more of the map's light than this is summed in double: what a float's rounding takes from a sun of 99.99 %
// would be more than all the light beside it.
constexpr float kBrightShare = 0.01f;

struct BrightAtom {
  Vec3d direction;
  Rgbd weight;
  int atom;
};

}  // namespace

struct BestLights::State {
  State(const PolarGrid& g, int n, Effort e)
      : grid(g),
        count(n),
        effort(e),
        maker(g, n),
        atoms(maker.capacity()),
        error(maker.capacity() + n + placement_kernel::kLanes),
        lights(n),
        powers(n),
        exchange(n, candidates_for(n)),
        tree(n),
        dark{powers.no_dark(), powers.no_dark(), powers.no_dark()},
        luminance_dark(powers.no_dark()) {
    const auto stride = static_cast<std::size_t>(powers.stride()) + placement_kernel::kLanes;
    for (auto* rows : {&power, &potential, &feedback, &target})
      for (auto& row : *rows) row.assign(stride, 0);
    for (auto* row : {&luminance_power, &still, &moving, &scratch}) row->assign(stride, 0);
    directions.assign(static_cast<std::size_t>(n), Vec3d::UnitY());
    moments.resize(static_cast<std::size_t>(n), MomentVector::Zero());
    ids.assign(static_cast<std::size_t>(n), 0);
    nearest.assign(atoms.x.size(), 0);
    distance.assign(atoms.x.size(), 0);
    quadrant_score.assign(4 * static_cast<std::size_t>(n), 0);
    quadrant_atom.assign(4 * static_cast<std::size_t>(n), -1);
    order.reserve(4 * static_cast<std::size_t>(n));
    bright.reserve(4 * (static_cast<std::size_t>(1 / kBrightShare) + 1));  // of luminance and of each channel
    moved.reserve(static_cast<std::size_t>(n));
    places.reserve(static_cast<std::size_t>(candidates_for(n)));
    place_points = Atoms(candidates_for(n));
    place_rest.assign(place_points.x.size() + 4, 0);
    predicted.assign(static_cast<std::size_t>(n), 0.0f);
    out.resize(static_cast<std::size_t>(n));
  }

  PolarGrid grid;
  int count;
  Effort effort;
  AtomMaker maker;
  Atoms atoms;
  // The last frame's error: its lights, and its atoms with their sign turned. Weights in shares of that frame's luminance.
  Atoms error;
  Eigen::Array3d error_total = Eigen::Array3d::Zero();  // that frame's illuminance
  double error_scale = 0;
  MomentMatrix atom_moments, error_moments;
  std::vector<BrightAtom> bright;  // their weights are not in the atoms while potentials are summed
  bool placed = false;
  bool placed_exactly = false;  // a light an atom: there were no more atoms
  bool stands_dark = false;     // spread out, before any light
  bool has_error = false;
  bool looked = false;       // at the atoms' nearest lights, as they stood before this frame's exchanges
  bool second_half = false;  // of the atoms is looked through next
  bool settling = false;     // one map until nothing pays any more

  std::vector<Vec3d> directions;
  std::vector<MomentVector> moments;  // of the lights
  std::vector<std::uint32_t> ids;
  std::uint32_t next_id = 1;
  Atoms lights;  // as points
  LightPowers powers;
  LightExchange exchange;
  PersistentTree tree;
  bool grown = false;  // the tree
  std::vector<int> moved;
  std::array<LightPowers::Dark, 3> dark;
  LightPowers::Dark luminance_dark;
  Rows power, potential, feedback, target;  // a light: its power, k with the map, k with the last error
  std::vector<double> luminance_power, still, moving, scratch;

  std::vector<int> nearest, quadrant_atom, order;
  std::vector<float> distance, quadrant_score;
  std::vector<Vec3d> places;
  Atoms place_points;
  std::vector<double> place_rest;
  Report report;
  std::vector<float> predicted;  // of the first lights up to an entry
  std::vector<DirectionalLight> out;

  static std::array<double*, 3> rows(Rows& r) { return {r[0].data(), r[1].data(), r[2].data()}; }

  void set_light(int i, const Vec3d& d) {
    const auto k = static_cast<std::size_t>(i);
    directions[k] = d.cast<float>().cast<double>();  // what the float kernels see
    moments[k] = lambertian_moments(directions[k]);
    ids[k] = next_id++;
    lights.x[k] = static_cast<float>(d.x());
    lights.y[k] = static_cast<float>(d.y());
    lights.z[k] = static_cast<float>(d.z());
    lights.ground[k] = static_cast<float>(ground_share(d.y()));
  }

  void add_moment_potential(const MomentVector& at, const MomentMatrix& of, std::size_t i, Rows& to) const {
    const Eigen::RowVector3d value = moment_weight() * at.transpose() * of;
    for (std::size_t c = 0; c < 3; ++c) to[c][i] += value[static_cast<Eigen::Index>(c)];
  }

  // k of one distribution with lights first … last − 1.
  void potentials_at(const Atoms& from, const MomentMatrix& of, int first, int last, Rows& to) {
    auto at = lights.points();
    at.x += first, at.y += first, at.z += first, at.s += first;
    at.count = last - first;
    auto out_rows = rows(to);
    for (double*& row : out_rows) row += first;
    placement_kernel::kernels().potentials(from.points(), from.weights().data(), kernel_shares(), at,
                                           out_rows.data());
    for (int i = first; i < last; ++i)
      add_moment_potential(moments[static_cast<std::size_t>(i)], of, static_cast<std::size_t>(i), to);
  }

  // Bright atoms out of the floats' sums, and back into them.
  void take_bright() {
    bright.clear();
    std::array<float, 3> least{};  // of a channel's own light
    for (std::size_t c = 0; c < 3; ++c)
      least[c] = kBrightShare * static_cast<float>(atoms.total[static_cast<Eigen::Index>(c)] / atoms.scale);
    for (int k = 0; k < atoms.count; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const bool is_bright =
          atoms.luminance[i] > kBrightShare || (least[0] > 0 && atoms.weight[0][i] > least[0]) ||
          (least[1] > 0 && atoms.weight[1][i] > least[1]) || (least[2] > 0 && atoms.weight[2][i] > least[2]);
      if (!is_bright || bright.size() == bright.capacity()) continue;
      bright.push_back({atoms.direction(k), atoms.weight_of(k), k});
      for (auto& plane : atoms.weight) plane[i] = 0;
    }
  }
  void return_bright() {
    for (const BrightAtom& b : bright)
      for (std::size_t c = 0; c < 3; ++c)
        atoms.weight[c][static_cast<std::size_t>(b.atom)] =
            static_cast<float>(b.weight[static_cast<Eigen::Index>(c)]);
  }
  void map_potentials(int first, int last) {
    potentials_at(atoms, atom_moments, first, last, potential);
    for (int i = first; i < last; ++i)
      for (const BrightAtom& b : bright) {
        const double k = error_kernel(directions[static_cast<std::size_t>(i)], b.direction);
        for (std::size_t c = 0; c < 3; ++c)
          potential[c][static_cast<std::size_t>(i)] += k * b.weight[static_cast<Eigen::Index>(c)];
      }
  }

  static void sum_moments(const Atoms& of, MomentMatrix& to) {
    to.setZero();
    placement_kernel::kernels().add_moments(of.points(), of.weights().data(), to.data());
  }

  void start() {
    lights.count = count;
    // place_lights works on whole atoms.
    return_bright();
    const std::vector<Vec3d> found = place_lights(atoms, count, grid.theta_max_rad, effort);
    take_bright();
    for (int i = 0; i < count; ++i) set_light(i, found[static_cast<std::size_t>(i)]);
    powers.place(directions);
    for (auto& d : dark) d = powers.no_dark();
    luminance_dark = powers.no_dark();
    placed = true;
    has_error = false;
    grown = false;
  }

  // The last error, in shares of this frame's luminance; light that went out takes its error with it.
  void scale_error() {
    Eigen::Array3d factor = Eigen::Array3d::Zero();
    if (has_error)
      for (int c = 0; c < 3; ++c) {
        const double before = error_total[c], now = atoms.total[c];
        factor[c] = before > 0 ? std::min(1.0, now / before) * (error_scale / atoms.scale) : 0;
        if (!std::isfinite(factor[c])) factor[c] = 0;
      }
    for (std::size_t c = 0; c < 3; ++c) {
      const double f = factor[static_cast<Eigen::Index>(c)];
      if (f == 1) continue;
      for (int k = 0; k < error.padded(); ++k)
        error.weight[c][static_cast<std::size_t>(k)] *= static_cast<float>(f);
      for (int i = 0; i < count; ++i) feedback[c][static_cast<std::size_t>(i)] *= f;
      error_moments.col(static_cast<Eigen::Index>(c)) *= f;
    }
  }

  static void to_luminance(const Rows& rgb, std::vector<double>& out_row, int n) {
    for (int i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      out_row[k] = 0.2126 * rgb[0][k] + 0.7152 * rgb[1][k] + 0.0722 * rgb[2][k];
    }
  }

  // Of every light and quadrant around it the atom that is served worst; the worst of these.
  void find_places() {
    // Many lights: half of the atoms one frame, the others the next.
    const bool by_halves = count > kAllAtomsUpTo && !settling;
    const int middle = atoms.padded() / 2 / placement_kernel::kLanes * placement_kernel::kLanes;
    const int begin = by_halves && second_half ? middle : 0;
    const int end = by_halves && !second_half ? middle : atoms.padded();
    second_half = !second_half;
    look_at_atoms(begin, end);
    std::fill(quadrant_score.begin(), quadrant_score.end(), 0.0f);
    std::fill(quadrant_atom.begin(), quadrant_atom.end(), -1);
    for (auto k = static_cast<std::size_t>(begin); k < static_cast<std::size_t>(std::min(end, atoms.count));
         ++k) {
      const auto i = static_cast<std::size_t>(nearest[k]);
      const float dx = atoms.x[k] - lights.x[i], dz = atoms.z[k] - lights.z[i];
      const float along = lights.z[i] * dx - lights.x[i] * dz;
      const float up = atoms.y[k] - lights.y[i];
      const std::size_t q = 4 * i + (along > 0 ? 1 : 0) + (up > 0 ? 2 : 0);
      if (distance[k] < kLeastDistance) continue;
      const float score = atoms.luminance[k] * distance[k];
      if (score > quadrant_score[q]) {
        quadrant_score[q] = score;
        quadrant_atom[q] = static_cast<int>(k);
      }
    }
    order.clear();
    for (std::size_t q = 0; q < quadrant_atom.size(); ++q)
      if (quadrant_atom[q] >= 0) order.push_back(static_cast<int>(q));
    const auto most = static_cast<std::size_t>(candidates_for(count));
    const auto worse = [&](int a, int b) {
      const float p = quadrant_score[static_cast<std::size_t>(a)],
                  q = quadrant_score[static_cast<std::size_t>(b)];
      return p > q || (p == q && a < b);
    };
    if (order.size() > most) {
      std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(most), order.end(), worse);
      order.resize(most);
    }
    places.clear();
    place_points.count = 0;
    for (const int q : order) {
      const Vec3d d = atoms.direction(quadrant_atom[static_cast<std::size_t>(q)]);
      places.push_back(d);
      place_points.add(d, Rgbd::Zero(), 0);
    }
    place_points.finish();
  }

  // The nearest light of each of these atoms; of the others none is known.
  void look_at_atoms(int begin, int end) {
    std::fill(nearest.begin(), nearest.end(), -1);
    auto points = atoms.points();
    points.x += begin, points.y += begin, points.z += begin, points.s += begin;
    points.count = end - begin;
    placement_kernel::kernels().nearest(points, light_points(), nearest.data() + begin,
                                        distance.data() + begin);
    looked = true;
  }

  placement_kernel::Points light_points() const {
    auto points = lights.points();
    points.count = count;
    return points;
  }

  void luminance_potential(const Atoms& from, const MomentMatrix& of, std::vector<double>& to) const {
    auto at = place_points.points();
    at.count = place_points.count;
    placement_kernel::kernels().potential(from.points(), from.luminance.data(), kernel_shares(), at,
                                          to.data());
    const MomentVector mean = of * Eigen::Vector3d(0.2126, 0.7152, 0.0722);
    for (std::size_t c = 0; c < places.size(); ++c)
      to[c] += moment_weight() * lambertian_moments(places[c]).dot(mean);
  }

  void exchange_lights() {
    to_luminance(potential, still, count);
    powers.solve(still, luminance_dark, luminance_power);
    exchange.weigh(powers, luminance_power, luminance_dark);
    report.exchanges = 0;
    find_places();
    if (places.empty()) return;
    luminance_potential(atoms, all_moments(), place_rest);
    LightExchange::Options options;
    options.most = std::clamp(2048 / count, 2, std::max(2, count / 4));
    options.hysteresis = kHysteresis;
    options.threshold = kThreshold;
    options.least_distance = 0.1 / std::sqrt(count);
    const auto pairs = exchange.choose(directions, luminance_power, places, place_rest, options);
    bool sound = true;
    for (const auto& [light, place] : pairs) {
      moved.push_back(light);
      set_light(light, places[static_cast<std::size_t>(place)]);
      sound = powers.move(light, directions) && sound;
      map_potentials(light, light + 1);
      if (has_error) potentials_at(error, error_moments, light, light + 1, feedback);
    }
    if (!sound) powers.place(directions);  // has not been seen to happen
    report.exchanges = static_cast<int>(pairs.size());
  }

  // As much of the last error as costs little beside what the lights are worth where they stand now.
  void bound_feedback() {
    report.feedback = 0;
    if (!has_error) return;
    to_luminance(potential, still, count);
    powers.solve(still, luminance_dark, luminance_power);
    to_luminance(feedback, moving, count);
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
      for (int i = 0; i < count; ++i) {
        const auto k = static_cast<std::size_t>(i);
        target[c][k] = potential[c][k] + report.feedback * feedback[c][k];
      }
      powers.solve(target[c], dark[c], power[c]);
      double sum = 0;
      for (int i = 0; i < count; ++i) sum += power[c][static_cast<std::size_t>(i)];
      for (int i = 0; i < count; ++i)
        power[c][static_cast<std::size_t>(i)] =
            sum > 0 ? power[c][static_cast<std::size_t>(i)] * (total / sum) : total / count;
    }
  }

  [[nodiscard]] MomentMatrix all_moments() const {
    MomentMatrix all = atom_moments;
    for (const BrightAtom& b : bright) all += lambertian_moments(b.direction) * b.weight.matrix().transpose();
    return all;
  }

  void keep_error() {
    return_bright();
    error.count = atoms.count;
    const auto copy = [&](const std::vector<float>& from, std::vector<float>& to, float sign) {
      for (std::size_t k = 0; k < static_cast<std::size_t>(atoms.count); ++k) to[k] = sign * from[k];
    };
    copy(atoms.x, error.x, 1);
    copy(atoms.y, error.y, 1);
    copy(atoms.z, error.z, 1);
    copy(atoms.ground, error.ground, 1);
    for (std::size_t c = 0; c < 3; ++c) copy(atoms.weight[c], error.weight[c], -1);
    error_moments = -all_moments();
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const Rgbd w(power[0][k], power[1][k], power[2][k]);
      error.add(directions[k], w, 0);
      error_moments += moments[k] * w.matrix().transpose();
    }
    error.finish();
    for (std::size_t c = 0; c < 3; ++c) {
      powers.potential(power[c], feedback[c]);
      for (int i = 0; i < count; ++i)
        feedback[c][static_cast<std::size_t>(i)] -= potential[c][static_cast<std::size_t>(i)];
    }
    error_total = atoms.total;
    error_scale = atoms.scale;
    has_error = true;
  }

  // What the lights show wrongly grows with how far atoms are from the light that stands for them and with what folding
  // leaves out; on the ground it is relative to the light that falls there.
  void predict_errors() {
    // Atoms at the distance of their light, which the frame's search for places has found (of half of them above
    // kAllAtomsUpTo lights).
    double cells = 0, looked_at = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(atoms.count); ++k) {
      if (nearest[k] < 0) continue;
      const auto share = static_cast<double>(atoms.luminance[k]);
      cells +=
          share * luminance_power[static_cast<std::size_t>(nearest[k])] * static_cast<double>(distance[k]);
      looked_at += share;
    }
    if (looked_at > 0) cells /= looked_at;
    double ground = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(atoms.count); ++k)
      ground += static_cast<double>(atoms.luminance[k] * std::max(0.0f, atoms.y[k]));
    const auto costs = tree.costs();
    double left_out = kOwnErrorOfCells * cells;
    for (std::size_t k = costs.size(); k-- > 0;) {
      predicted[k] = ground > 0 ? static_cast<float>(kErrorOfCost * std::sqrt(left_out) / ground) : 0.0f;
      left_out += std::max(0.0, costs[k]);
    }
  }

  void write_out() {
    to_luminance(power, luminance_power, count);
    const PersistentTree::Lights now{directions, luminance_power, powers.matrix(), powers.stride()};
    if (grown)
      tree.follow(now, moved);
    else
      tree.build(now);
    grown = true;
    const auto entries = tree.order();
    if (!looked) look_at_atoms(0, atoms.padded());
    looked = false;
    predict_errors();
    for (std::size_t k = 0; k < entries.size(); ++k) {
      const auto i = static_cast<std::size_t>(entries[k].light);
      DirectionalLight& light = out[k];
      light.direction = directions[i].cast<float>().normalized();
      for (std::size_t c = 0; c < 3; ++c)
        light.illuminance[static_cast<Eigen::Index>(c)] = static_cast<float>(power[c][i] * atoms.scale);
      light.id = ids[i];
      light.parent = entries[k].parent;
      light.predicted_error = predicted[k];
    }
  }

  // Of the map of the last frame: exchanges until none pays, then all lights down to the nearest places of least cost.
  void improve() {
    settling = true;
    take_bright();
    for (int round = 0; round < kImprovements; ++round) {
      for (int pass = 0; pass < kPasses; ++pass) {
        has_error = false;
        exchange_lights();
        if (report.exchanges == 0) break;
      }
      if (round + 1 < kImprovements) place_at(descend_lights(atoms, directions, grid.theta_max_rad, kSteps));
    }
    snap_to_bright();
    looked = false;
    settling = false;
    grown = false;
    solve_powers();
    keep_error();
    write_out();
  }

  // A descent's last steps are long beside what a sun forgives: a light this near to a bright atom is meant for it.
  void snap_to_bright() {
    bool any = false;
    for (const BrightAtom& b : bright) {
      int nearest_light = 0;
      for (int i = 1; i < count; ++i)
        if ((directions[static_cast<std::size_t>(i)] - b.direction).squaredNorm() <
            (directions[static_cast<std::size_t>(nearest_light)] - b.direction).squaredNorm())
          nearest_light = i;
      const double away = (directions[static_cast<std::size_t>(nearest_light)] - b.direction).norm();
      const double reach =
          luminance(b.weight) > 0.5 ? 0.0175 : static_cast<double>(kLeastDistance);  // 1°, 0.2°
      if (away == 0 || away > reach) continue;
      set_light(nearest_light, b.direction);
      any = true;
    }
    if (!any) return;
    powers.place(directions);
    map_potentials(0, count);
  }

  void place_at(const std::vector<Vec3d>& found) {
    for (int i = 0; i < count; ++i) set_light(i, found[static_cast<std::size_t>(i)]);
    powers.place(directions);
    grown = false;
    map_potentials(0, count);
  }

  // Atoms as they are, one light each.
  void show_all_atoms() {
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const bool lit = i < atoms.count;
      const Vec3d d = lit ? atoms.direction(i) : atoms.direction(0);
      if (!placed_exactly || directions[k] != d) set_light(i, d);
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
    placed = has_error = grown = false;
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      out[k] = {directions[k].cast<float>().normalized(), Rgb::Zero(), -1, ids[k]};
      for (std::size_t c = 0; c < 3; ++c)
        out[k].illuminance[static_cast<Eigen::Index>(c)] = static_cast<float>(power[c][k] * atoms.scale);
    }
    out = progressive_order(out);
  }

  void process(const PolarMap& map) {
    maker.make(map, atoms);
    report = {};
    moved.clear();
    if (!(atoms.scale > 0)) {
      for (DirectionalLight& light : out) {
        light.illuminance = Rgb::Zero();
        light.predicted_error = 0;
      }
      if (!placed && !placed_exactly && !stands_dark) stand_dark();
      has_error = false;
      return;
    }
    if (atoms.count <= count) {
      show_all_atoms();
      return;
    }
    placed_exactly = stands_dark = false;
    take_bright();
    sum_moments(atoms, atom_moments);
    const bool first = !placed;
    if (first) start();
    if (has_error) scale_error();
    map_potentials(0, count);
    if (first)
      snap_to_bright();
    else
      exchange_lights();
    bound_feedback();
    solve_powers();
    keep_error();
    write_out();
    if (first && effort == Effort::thorough) improve();
  }

  // Before any light: a tree of lights spread over the cap, all dark.
  void stand_dark() {
    stands_dark = true;
    const double reach = 1 - std::cos(std::min(grid.theta_max_rad, kPi));
    for (int i = 0; i < count; ++i) {
      const double y = 1 - (i + 0.5) / count * reach;
      set_light(i, direction_from_spherical({std::acos(std::clamp(y, -1.0, 1.0)), 2.399963 * i}));
    }
    for (auto& row : power) std::fill(row.begin(), row.end(), 0.0);
    powers.place(directions);
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
  state_->has_error = false;
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
