// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/atoms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace lightwell {
namespace {

constexpr double kDegree = kPi / 180;

struct Block {
  int ring0, ring1;
  int sector0, sector1;
};

// A bin's luminance in lux, 0 for what is not light.
class BinLight {
 public:
  explicit BinLight(const PolarMap& map) : map_(map) {}

  [[nodiscard]] Rgbd illuminance(std::size_t bin) const {
    Rgbd value = map_.rgb(bin).cast<double>() * static_cast<double>(map_.solid_angle_sr[bin]);
    for (int c = 0; c < 3; ++c)
      if (!(value[c] > 0) || !std::isfinite(value[c])) value[c] = 0;
    return value;
  }

 private:
  const PolarMap& map_;
};

class AtomBuilder {
 public:
  AtomBuilder(const PolarMap& map, const AtomOptions& options) : map_(map), options_(options), light_(map) {
    luminance_.resize(map.grid.size());
    for (std::size_t bin = 0; bin < luminance_.size(); ++bin) {
      const Rgbd value = light_.illuminance(bin);
      luminance_[bin] = luminance(value);
      total_ += value;
    }
    for (int sector = 0; sector < map.grid.sectors; ++sector) {
      const double lambda = 2 * kPi * (sector + 0.5) / map.grid.sectors;
      azimuth_.push_back({std::sin(lambda), std::cos(lambda)});
    }
  }

  Atoms build() {
    Atoms atoms;
    atoms.total = total_;
    atoms.scale = luminance(total_);
    if (atoms.scale > 0) add_all();
    const auto count = static_cast<Eigen::Index>(found_.size());
    atoms.direction.resize(3, count);
    atoms.illuminance.resize(count, 3);
    atoms.luminance.resize(count);
    atoms.solid_angle_sr.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Found& atom = found_[static_cast<std::size_t>(i)];
      atoms.direction.col(i) = atom.direction;
      atoms.illuminance.row(i) = (atom.illuminance / atoms.scale).matrix().transpose();
      atoms.luminance[i] = luminance(Rgbd(atom.illuminance / atoms.scale));
      atoms.solid_angle_sr[i] = atom.solid_angle_sr;
    }
    return atoms;
  }

 private:
  struct Found {
    Vec3d direction;
    Rgbd illuminance;
    double solid_angle_sr;
  };

  void add_all() {
    const PolarGrid& grid = map_.grid;
    const int rows =
        std::clamp(static_cast<int>(std::lround(grid.theta_max_rad / (6 * kDegree))), 1, grid.rings);
    for (int row = 0; row < rows; ++row) {
      const int ring0 = edge(0, grid.rings, row, rows);
      const int ring1 = edge(0, grid.rings, row + 1, rows);
      // Blocks keep about their width on the sphere: 60° and 24° of azimuth in the two rows at a pole.
      const double middle = grid.theta_max_rad * (ring0 + ring1) / (2.0 * grid.rings);
      const double from_pole = std::min(middle, kPi - middle);
      const int columns = std::min(grid.sectors, from_pole < 6 * kDegree    ? 6
                                                 : from_pole < 12 * kDegree ? 15
                                                                            : 30);
      for (int column = 0; column < columns; ++column)
        add({ring0, ring1, edge(0, grid.sectors, column, columns),
             edge(0, grid.sectors, column + 1, columns)},
            0);
    }
  }

  // level 0: 6° × 12°, 1: 3° × 6°, 2: 1° × 1°
  void add(const Block& block, int level) {
    const double share = sum(block) / luminance(total_);
    if (!(share > 0)) return;
    if (level == 2 || share <= (level == 0 ? options_.coarse_share : options_.fine_share)) {
      emit(block);
      return;
    }
    const int rows = std::min(level == 0 ? 2 : 3, block.ring1 - block.ring0);
    const int columns = std::min(level == 0 ? 2 : 6, block.sector1 - block.sector0);
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column)
        add({edge(block.ring0, block.ring1, row, rows), edge(block.ring0, block.ring1, row + 1, rows),
             edge(block.sector0, block.sector1, column, columns),
             edge(block.sector0, block.sector1, column + 1, columns)},
            level + 1);
  }

  void emit(const Block& block) {
    Vec3d moment = Vec3d::Zero();
    Found atom{Vec3d::UnitY(), Rgbd::Zero(), 0};
    for (int ring = block.ring0; ring < block.ring1; ++ring) {
      const double theta = map_.grid.theta_max_rad * (ring + 0.5) / map_.grid.rings;
      double sine = 0;
      double cosine = 0;
      double all = 0;
      for (int sector = block.sector0; sector < block.sector1; ++sector) {
        const std::size_t bin = index(ring, sector);
        const double weight = luminance_[bin];
        sine += weight * azimuth_[static_cast<std::size_t>(sector)][0];
        cosine += weight * azimuth_[static_cast<std::size_t>(sector)][1];
        all += weight;
        atom.illuminance += light_.illuminance(bin);
        atom.solid_angle_sr += static_cast<double>(map_.solid_angle_sr[bin]);
      }
      moment += Vec3d(std::sin(theta) * sine, std::cos(theta) * all, std::sin(theta) * cosine);
    }
    const double length = moment.norm();
    // Only a map of a bin or two has blocks so large that their light cancels; its middle stands for it then.
    atom.direction =
        length > 1e-9 * luminance(atom.illuminance)
            ? Vec3d(moment / length)
            : map_.grid.bin_direction((block.ring0 + block.ring1) / 2, (block.sector0 + block.sector1) / 2);
    found_.push_back(atom);
  }

  [[nodiscard]] double sum(const Block& block) const {
    double total = 0;
    for (int ring = block.ring0; ring < block.ring1; ++ring)
      for (int sector = block.sector0; sector < block.sector1; ++sector)
        total += luminance_[index(ring, sector)];
    return total;
  }
  [[nodiscard]] std::size_t index(int ring, int sector) const {
    return static_cast<std::size_t>(ring) * static_cast<std::size_t>(map_.grid.sectors) +
           static_cast<std::size_t>(sector);
  }
  static int edge(int begin, int end, int part, int parts) {
    return begin + static_cast<int>(std::int64_t{end - begin} * part / parts);
  }

  const PolarMap& map_;
  AtomOptions options_;
  BinLight light_;
  std::vector<double> luminance_;
  std::vector<std::array<double, 2>> azimuth_;  // sine, cosine
  Rgbd total_ = Rgbd::Zero();
  std::vector<Found> found_;
};

// A range of the index array, with what a division is decided by.
struct Group {
  Eigen::Index begin, end;
  double luminance;
};

// Puts the group's atoms in order along its widest axis; the first half in luminance ends before the returned
// place.
Eigen::Index halve(const Atoms& atoms, std::vector<Eigen::Index>& order, const Group& group) {
  const auto begin = order.begin() + group.begin;
  const auto end = order.begin() + group.end;
  Vec3d mean = Vec3d::Zero();
  Vec3d square = Vec3d::Zero();
  for (auto i = begin; i != end; ++i) {
    const Vec3d d = atoms.direction.col(*i);
    mean += atoms.luminance[*i] * d;
    square += atoms.luminance[*i] * d.cwiseProduct(d);
  }
  mean /= group.luminance;
  Eigen::Index axis = 0;
  (square / group.luminance - mean.cwiseProduct(mean)).maxCoeff(&axis);
  std::sort(begin, end, [&](Eigen::Index a, Eigen::Index b) {
    const double x = atoms.direction(axis, a);
    const double y = atoms.direction(axis, b);
    return x < y || (x == y && a < b);
  });
  double below = 0;
  Eigen::Index at = group.begin;
  while (at < group.end - 1 &&
         below + atoms.luminance[order[static_cast<std::size_t>(at)]] <= group.luminance / 2)
    below += atoms.luminance[order[static_cast<std::size_t>(at++)]];
  return std::max(at, group.begin + 1);
}

std::vector<Group> divide(const Atoms& atoms, std::vector<Eigen::Index>& order, Eigen::Index count) {
  const auto darker = [](const Group& a, const Group& b) { return a.luminance < b.luminance; };
  std::vector<Group> heap = {{0, atoms.size(), atoms.luminance.sum()}};
  std::vector<Group> groups;  // of one atom each: cannot be divided
  while (!heap.empty() && static_cast<Eigen::Index>(heap.size() + groups.size()) < count) {
    std::pop_heap(heap.begin(), heap.end(), darker);
    const Group group = heap.back();
    heap.pop_back();
    if (group.end - group.begin < 2) {
      groups.push_back(group);
      continue;
    }
    const Eigen::Index middle = halve(atoms, order, group);
    for (Group half : {Group{group.begin, middle, 0}, Group{middle, group.end, 0}}) {
      for (Eigen::Index i = half.begin; i < half.end; ++i)
        half.luminance += atoms.luminance[order[static_cast<std::size_t>(i)]];
      heap.push_back(half);
      std::push_heap(heap.begin(), heap.end(), darker);
    }
  }
  groups.insert(groups.end(), heap.begin(), heap.end());
  return groups;
}

}  // namespace

Atoms make_atoms(const PolarMap& map, const AtomOptions& options) {
  return AtomBuilder(map, options).build();
}

Atoms merge_atoms(const Atoms& atoms, Eigen::Index count) {
  if (atoms.size() <= count) return atoms;
  std::vector<Eigen::Index> order(static_cast<std::size_t>(atoms.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  const std::vector<Group> groups = divide(atoms, order, count);
  Atoms merged;
  merged.scale = atoms.scale;
  merged.total = atoms.total;
  const auto size = static_cast<Eigen::Index>(groups.size());
  merged.direction.resize(3, size);
  merged.illuminance.setZero(size, 3);
  merged.luminance.setZero(size);
  merged.solid_angle_sr.setZero(size);
  for (Eigen::Index g = 0; g < size; ++g) {
    const Group& group = groups[static_cast<std::size_t>(g)];
    Vec3d moment = Vec3d::Zero();
    for (Eigen::Index k = group.begin; k < group.end; ++k) {
      const Eigen::Index i = order[static_cast<std::size_t>(k)];
      moment += atoms.luminance[i] * atoms.direction.col(i);
      merged.illuminance.row(g) += atoms.illuminance.row(i);
      merged.luminance[g] += atoms.luminance[i];
      merged.solid_angle_sr[g] += atoms.solid_angle_sr[i];
    }
    const double length = moment.norm();
    merged.direction.col(g) = length > 1e-9 * merged.luminance[g]
                                  ? Vec3d(moment / length)
                                  : Vec3d(atoms.direction.col(order[static_cast<std::size_t>(group.begin)]));
  }
  return merged;
}

}  // namespace lightwell
