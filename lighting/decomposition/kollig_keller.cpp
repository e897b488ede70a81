// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/kollig_keller.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <queue>
#include <span>
#include <utility>

#include "lighting/decomposition/cell_powers.h"
#include "lighting/decomposition/lit_bins.h"
#include "lighting/decomposition/uniform_lights.h"
#include "lighting/decomposition/voronoi_cells.h"
#include "lighting/spherical_cap.h"

namespace lightwell {
namespace {

// A light that would move less than this share of the lights' mean spacing stays. Coarse and few passes while
// lights are added, for the next one disturbs them again: finer ones took ten times as long and ended no better.
constexpr double kStillWhileAdding = 0.03;
constexpr double kStillAtTheEnd = 0.003;
constexpr int kPassesWhileAdding = 3;
constexpr int kPassesAtTheEnd = 100;

class LloydRelaxation {
 public:
  LloydRelaxation(const LitBins& bins, double solid_angle_sr)
      : bins_(bins), solid_angle_(solid_angle_sr), cells_(bins) {}

  std::vector<Vec3d> places(std::size_t count) {
    add(first_place());
    while (cells_.places().size() < count && split_strongest()) relax(kPassesWhileAdding, kStillWhileAdding);
    for (std::uint32_t p = 0; p < sums_.size(); ++p) touch(p);
    relax(kPassesAtTheEnd, kStillAtTheEnd);
    return cells_.places();
  }

 private:
  struct Sum {
    double power = 0;
    Vec3d moment = Vec3d::Zero();
    std::size_t bins = 0;
    bool touched = false;
  };

  [[nodiscard]] Vec3d first_place() const {
    Vec3d moment = Vec3d::Zero();
    for (std::size_t i = 0; i < bins_.size(); ++i) moment += bins_.power[i] * bins_.direction[i];
    if (moment.norm() > 1e-9) return moment.normalized();
    const auto brightest = std::max_element(bins_.power.begin(), bins_.power.end());
    return bins_.direction[static_cast<std::size_t>(brightest - bins_.power.begin())];
  }

  void touch(std::uint32_t place) {
    if (sums_[place].touched) return;
    sums_[place].touched = true;
    touched_.push_back(place);
  }

  void account(std::span<const VoronoiCells::Change> changes) {
    const auto give = [&](std::uint32_t place, std::size_t bin, int sign) {
      Sum& sum = sums_[place];
      const double power = sign * bins_.power[bin];
      sum.power += power;
      sum.moment += power * bins_.direction[bin];
      sum.bins += static_cast<std::size_t>(sign);
      touch(place);
    };
    for (const VoronoiCells::Change& c : changes) {
      if (c.from != VoronoiCells::kNone) give(c.from, c.bin, -1);
      give(c.to, c.bin, 1);
    }
    for (const std::uint32_t p : touched_) strongest_.emplace(sums_[p].power, p);
  }

  void add(const Vec3d& place) {
    sums_.emplace_back();
    account(cells_.add(place));
  }

  // A light at the bin of the strongest divisible cell that has most power × squared distance to its light.
  bool split_strongest() {
    while (!strongest_.empty()) {
      const auto [power, place] = strongest_.top();
      strongest_.pop();
      if (power != sums_[place].power || sums_[place].bins < 2) continue;  // of an earlier state; indivisible
      add(bins_.direction[farthest_of(place)]);
      return true;
    }
    return false;
  }

  [[nodiscard]] std::size_t farthest_of(std::uint32_t place) const {
    std::size_t farthest = 0;
    double most = -1;
    for (std::size_t block = 0; block < bins_.blocks.size(); ++block) {
      if (!cells_.may_hold(block, place)) continue;
      for (std::size_t i = bins_.blocks[block].begin; i < bins_.blocks[block].end; ++i) {
        if (cells_.cell(i) != place) continue;
        const double moment = bins_.power[i] * (1 - cells_.cosine(i));
        if (moment > most) {
          most = moment;
          farthest = i;
        }
      }
    }
    return farthest;
  }

  void relax(int passes, double still) {
    const double spacing = std::sqrt(solid_angle_ / static_cast<double>(sums_.size()));
    std::vector<VoronoiCells::Move> moves;
    for (int pass = 0; pass < passes && !touched_.empty(); ++pass) {
      moves.clear();
      for (const std::uint32_t p : touched_) {
        sums_[p].touched = false;
        const double length = sums_[p].moment.norm();
        if (sums_[p].bins == 0 || !(length > 1e-9 * sums_[p].power)) continue;
        const Vec3d mean = sums_[p].moment / length;
        if ((mean - cells_.places()[p]).norm() > still * spacing) moves.push_back({p, mean});
      }
      touched_.clear();
      account(cells_.move(moves));
    }
  }

  const LitBins& bins_;
  double solid_angle_;  // of the map
  VoronoiCells cells_;
  std::vector<Sum> sums_;               // of each place's cell
  std::vector<std::uint32_t> touched_;  // places whose cells changed since they last moved
  std::priority_queue<std::pair<double, std::uint32_t>>
      strongest_;  // power and place, old entries among them
};

}  // namespace

std::vector<DirectionalLight> kollig_keller(const PolarMap& map, int count) {
  const LitBins bins = lit_bins(map);
  if (bins.empty()) return dark_lights(map.grid, count);
  const double solid_angle = 2 * kPi * cap_measure(map.grid.theta_max_rad);
  const std::vector<Vec3d> places =
      LloydRelaxation(bins, solid_angle).places(static_cast<std::size_t>(count));
  return lights_of_cells(map, bins, places, static_cast<std::size_t>(count));
}

}  // namespace lightwell
