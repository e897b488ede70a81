// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/atoms.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "lighting/decomposition/error_kernel.h"

namespace lightwell {
namespace {

constexpr double kDegree = kPi / 180;
constexpr int kColumns = 60;  // of 6°
constexpr int kMostAtoms = 6144;
constexpr int kPartsOfACell = 18;  // 3 × 6
// A part with so much of the light is shown bin by bin: a sun's own disc and glare, where the map resolves them.
constexpr double kBinsFromShare = 1.0 / 200;

int edge(int begin, int end, int part, int parts) {
  return begin + static_cast<int>(std::int64_t{end - begin} * part / parts);
}

// Blocks keep about their width on the sphere: 60° and 24° of azimuth in the two rows at a pole.
int columns_together(double theta_rad) {
  const double from_pole = std::min(theta_rad, kPi - theta_rad);
  return from_pole < 6 * kDegree ? 5 : from_pole < 12 * kDegree ? 2 : 1;
}

int to_lanes(int n) {
  return (n + placement_kernel::kLanes - 1) / placement_kernel::kLanes * placement_kernel::kLanes;
}

}  // namespace

Atoms::Atoms(int capacity) {
  const auto size = static_cast<std::size_t>(to_lanes(capacity));
  for (auto* plane : {&x, &y, &z, &ground, &weight[0], &weight[1], &weight[2], &luminance, &solid_angle_sr})
    plane->assign(size, 0.0f);
}

int Atoms::padded() const {
  return to_lanes(count);
}

placement_kernel::Points Atoms::points() const {
  return {x.data(), y.data(), z.data(), ground.data(), padded()};
}

std::array<const float*, 3> Atoms::weights() const {
  return {weight[0].data(), weight[1].data(), weight[2].data()};
}

Rgbd Atoms::weight_of(int k) const {
  const auto i = static_cast<std::size_t>(k);
  return Rgb(weight[0][i], weight[1][i], weight[2][i]).cast<double>();
}

Vec3d Atoms::direction(int k) const {
  const auto i = static_cast<std::size_t>(k);
  return Vec3f(x[i], y[i], z[i]).cast<double>();
}

void Atoms::add(const Vec3d& direction, const Rgbd& share, double omega) noexcept {
  const auto i = static_cast<std::size_t>(count++);
  x[i] = static_cast<float>(direction.x());
  y[i] = static_cast<float>(direction.y());
  z[i] = static_cast<float>(direction.z());
  ground[i] = static_cast<float>(ground_share(direction.y()));
  for (std::size_t c = 0; c < 3; ++c) weight[c][i] = static_cast<float>(share[static_cast<Eigen::Index>(c)]);
  luminance[i] = static_cast<float>(lightwell::luminance(share));
  solid_angle_sr[i] = static_cast<float>(omega);
}

void Atoms::finish() noexcept {
  for (auto i = static_cast<std::size_t>(count); i < static_cast<std::size_t>(padded()); ++i)
    x[i] = y[i] = z[i] = ground[i] = weight[0][i] = weight[1][i] = weight[2][i] = luminance[i] =
        solid_angle_sr[i] = 0;
}

AtomMaker::AtomMaker(const PolarGrid& grid, int lights, Detail detail)
    : grid_(grid),
      coarse_share_(detail == Detail::frame ? 1.0 / std::max(400, 8 * lights)
                                            : 1.0 / std::max(1500, 10 * lights)),
      fine_share_(1.0 / std::max(detail == Detail::frame ? 600 : 800, 5 * lights)) {
  const int rows = std::max(1, static_cast<int>(std::lround(grid.theta_max_rad / (6 * kDegree))));
  for (int row = 0; row <= 2 * rows; ++row) rows_.push_back(edge(0, grid.rings, row, 2 * rows));
  for (int column = 0; column <= kColumns; ++column)
    columns_.push_back(edge(0, grid.sectors, column, kColumns));
  for (int sector = 0; sector < grid.sectors; ++sector) {
    const double lambda = 2 * kPi * (sector + 0.5) / grid.sectors;
    sine_.push_back(static_cast<float>(std::sin(lambda)));
    cosine_.push_back(static_cast<float>(std::cos(lambda)));
  }
  for (int ring = 0; ring < grid.rings; ++ring) {
    const double theta = grid.theta_max_rad * (ring + 0.5) / grid.rings;
    ring_sine_.push_back(std::sin(theta));
    ring_cosine_.push_back(std::cos(theta));
    bin_solid_angle_sr_.push_back(grid.bin_solid_angle_sr(ring));
  }
  for (auto& sum : sums_) sum.resize(sine_.size());
  cells_.resize(static_cast<std::size_t>(2 * rows * kColumns));
  // At the most every cell divided once, and the rest of the room for what is divided again.
  capacity_ = static_cast<int>(std::min<std::size_t>(kMostAtoms, std::max<std::size_t>(grid.size(), 1))) +
              2 * rows * kColumns + kPartsOfACell;
}

void AtomMaker::sum_cells(const PolarMap& map) noexcept {
  const auto& kernel = placement_kernel::kernels();
  const auto sectors = static_cast<std::size_t>(grid_.sectors);
  const int last = map.channels == 1 ? 0 : 2;
  for (std::size_t row = 0; row + 1 < rows_.size(); ++row) {
    for (auto& sum : sums_) std::fill(sum.begin(), sum.end(), 0.0f);
    for (int ring = rows_[row]; ring < rows_[row + 1]; ++ring) {
      const std::size_t at = static_cast<std::size_t>(ring) * sectors;
      kernel.add_ring({map.plane(0).data() + at, map.plane(last / 2).data() + at, map.plane(last).data() + at,
                       map.solid_angle_sr.data() + at},
                      grid_.sectors, static_cast<float>(ring_sine_[static_cast<std::size_t>(ring)]),
                      static_cast<float>(ring_cosine_[static_cast<std::size_t>(ring)]),
                      {sums_[0].data(), sums_[1].data(), sums_[2].data(), sums_[3].data(), sums_[4].data()});
    }
    for (int column = 0; column < kColumns; ++column) {
      double r = 0, g = 0, b = 0, x = 0, y = 0, z = 0;
      for (int sector = columns_[static_cast<std::size_t>(column)];
           sector < columns_[static_cast<std::size_t>(column) + 1]; ++sector) {
        const auto s = static_cast<std::size_t>(sector);
        const auto across = static_cast<double>(sums_[3][s]);
        r += static_cast<double>(sums_[0][s]);
        g += static_cast<double>(sums_[1][s]);
        b += static_cast<double>(sums_[2][s]);
        x += across * static_cast<double>(sine_[s]);
        y += static_cast<double>(sums_[4][s]);
        z += across * static_cast<double>(cosine_[s]);
      }
      cells_[row * kColumns + static_cast<std::size_t>(column)] = {r, g, b, x, y, z};
    }
  }
}

AtomMaker::Cell AtomMaker::sum_bins(const PolarMap& map, const Block& block) const noexcept {
  Cell sum{};
  for (int ring = block.ring0; ring < block.ring1; ++ring) {
    const double sin_theta = ring_sine_[static_cast<std::size_t>(ring)];
    const double cos_theta = ring_cosine_[static_cast<std::size_t>(ring)];
    for (int sector = block.sector0; sector < block.sector1; ++sector) {
      const auto s = static_cast<std::size_t>(sector);
      const std::size_t bin = static_cast<std::size_t>(ring) * static_cast<std::size_t>(grid_.sectors) + s;
      Rgbd value = map.rgb(bin).cast<double>() * static_cast<double>(map.solid_angle_sr[bin]);
      for (int c = 0; c < 3; ++c)
        if (!(value[c] > 0) || !std::isfinite(value[c])) value[c] = 0;
      const double y = luminance(value);
      sum.r += value[0];
      sum.g += value[1];
      sum.b += value[2];
      sum.x += y * sin_theta * static_cast<double>(sine_[s]);
      sum.y += y * cos_theta;
      sum.z += y * sin_theta * static_cast<double>(cosine_[s]);
    }
  }
  return sum;
}

double AtomMaker::solid_angle(const Block& block) const noexcept {
  double sum = 0;
  for (int ring = block.ring0; ring < block.ring1; ++ring)
    sum += bin_solid_angle_sr_[static_cast<std::size_t>(ring)];
  return sum * (block.sector1 - block.sector0);
}

void AtomMaker::add_block(const Cell& cell, const Block& block, Atoms& atoms) const noexcept {
  const Rgbd value(cell.r, cell.g, cell.b);
  const double y = luminance(value);
  if (!(y > 0) || atoms.count >= capacity_) return;
  const Vec3d moment(cell.x, cell.y, cell.z);
  const double length = moment.norm();
  // Only a map of a bin or two has blocks so large that their light cancels; its middle stands for it then.
  const Vec3d direction = length > 1e-6 * y ? Vec3d(moment / length)
                                            : grid_.bin_direction((block.ring0 + block.ring1) / 2,
                                                                  (block.sector0 + block.sector1) / 2);
  atoms.add(direction, value / atoms.scale, solid_angle(block));
}

// One cell, its bins 1° × 1° or so at a time; kept_free: places for what comes after it.
void AtomMaker::add_parts(const PolarMap& map, const Block& block, int kept_free,
                          Atoms& atoms) const noexcept {
  const int rings = std::min(3, block.ring1 - block.ring0);
  const int columns = std::min(6, block.sector1 - block.sector0);
  for (int ring = 0; ring < rings; ++ring)
    for (int column = 0; column < columns; ++column) {
      const Block part{edge(block.ring0, block.ring1, ring, rings),
                       edge(block.ring0, block.ring1, ring + 1, rings),
                       edge(block.sector0, block.sector1, column, columns),
                       edge(block.sector0, block.sector1, column + 1, columns)};
      const Cell sum = sum_bins(map, part);
      const int bins = (part.ring1 - part.ring0) * (part.sector1 - part.sector0);
      const bool bright = luminance(Rgbd(sum.r, sum.g, sum.b)) > kBinsFromShare * atoms.scale;
      if (!bright || bins < 2 || atoms.count + bins + kept_free > capacity_) {
        add_block(sum, part, atoms);
        continue;
      }
      for (int r = part.ring0; r < part.ring1; ++r)
        for (int s = part.sector0; s < part.sector1; ++s) {
          const Block bin{r, r + 1, s, s + 1};
          add_block(sum_bins(map, bin), bin, atoms);
        }
    }
}

void AtomMaker::make(const PolarMap& map, Atoms& atoms) noexcept {
  atoms.count = 0;
  sum_cells(map);
  atoms.total = Rgbd::Zero();
  for (const Cell& cell : cells_) atoms.total += Rgbd(cell.r, cell.g, cell.b);
  atoms.scale = luminance(atoms.total);
  if (!(atoms.scale > 0)) {
    atoms.scale = 0;
    return;
  }
  const auto add = [](Cell& to, const Cell& c) {
    to.r += c.r, to.g += c.g, to.b += c.b;
    to.x += c.x, to.y += c.y, to.z += c.z;
  };
  const double coarse = coarse_share_ * atoms.scale, fine = fine_share_ * atoms.scale;
  const int rows = static_cast<int>(rows_.size()) - 1;
  for (int row = 0; row < rows; row += 2) {
    const double middle = grid_.theta_max_rad * (row + 1) / rows;
    const int together = columns_together(middle);
    for (int column = 0; column < kColumns; column += 2 * together) {
      Cell quarter[2][2] = {};
      for (int i = 0; i < 2; ++i)
        for (int k = 0; k < 2 * together; ++k)
          if (column + k < kColumns)
            add(quarter[i][k / together],
                cells_[static_cast<std::size_t>((row + i) * kColumns + column + k)]);
      Cell whole{};
      for (auto& line : quarter)
        for (const Cell& cell : line) add(whole, cell);
      const auto at = [&](int i, int k) {
        const auto c = [&](int n) { return columns_[static_cast<std::size_t>(std::min(n, kColumns))]; };
        return Block{rows_[static_cast<std::size_t>(row + i)], rows_[static_cast<std::size_t>(row + i + 1)],
                     c(column + k * together), c(column + (k + 1) * together)};
      };
      const Block all{at(0, 0).ring0, at(1, 0).ring1, at(0, 0).sector0, at(0, 1).sector1};
      if (luminance(Rgbd(whole.r, whole.g, whole.b)) <= coarse) {
        add_block(whole, all, atoms);
        continue;
      }
      for (int i = 0; i < 2; ++i)
        for (int k = 0; k < 2; ++k) {
          const Cell& cell = quarter[i][k];
          const int room = capacity_ - atoms.count - (rows - row) * kColumns;
          if (luminance(Rgbd(cell.r, cell.g, cell.b)) > fine && room >= kPartsOfACell)
            add_parts(map, at(i, k), (rows - row) * kColumns + kPartsOfACell, atoms);
          else
            add_block(cell, at(i, k), atoms);
        }
    }
  }
  atoms.finish();
}

namespace {

// A range of the index array, with what a division is decided by.
struct Group {
  int begin, end;
  double luminance;
};

// Puts the group's atoms in order along its widest axis; the first half in luminance ends before the returned place.
int halve(const Atoms& atoms, std::vector<int>& order, const Group& group) {
  const auto begin = order.begin() + group.begin;
  const auto end = order.begin() + group.end;
  Vec3d mean = Vec3d::Zero();
  Vec3d square = Vec3d::Zero();
  for (auto i = begin; i != end; ++i) {
    const Vec3d d = atoms.direction(*i);
    const auto weight = static_cast<double>(atoms.luminance[static_cast<std::size_t>(*i)]);
    mean += weight * d;
    square += weight * d.cwiseProduct(d);
  }
  mean /= group.luminance;
  Eigen::Index axis = 0;
  (square / group.luminance - mean.cwiseProduct(mean)).maxCoeff(&axis);
  const std::vector<float>& along = axis == 0 ? atoms.x : axis == 1 ? atoms.y : atoms.z;
  std::sort(begin, end, [&](int a, int b) {
    const float p = along[static_cast<std::size_t>(a)];
    const float q = along[static_cast<std::size_t>(b)];
    return p < q || (p == q && a < b);
  });
  double below = 0;
  int at = group.begin;
  const auto weight_at = [&](int i) {
    return static_cast<double>(atoms.luminance[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])]);
  };
  while (at < group.end - 1 && below + weight_at(at) <= group.luminance / 2) below += weight_at(at++);
  return std::max(at, group.begin + 1);
}

std::vector<Group> divide(const Atoms& atoms, std::vector<int>& order, int count) {
  const auto darker = [](const Group& a, const Group& b) { return a.luminance < b.luminance; };
  const auto sum = [&](int begin, int end) {
    double total = 0;
    for (int i = begin; i < end; ++i)
      total +=
          static_cast<double>(atoms.luminance[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])]);
    return total;
  };
  std::vector<Group> heap = {{0, atoms.count, sum(0, atoms.count)}};
  std::vector<Group> groups;  // of one atom each: cannot be divided
  while (!heap.empty() && static_cast<int>(heap.size() + groups.size()) < count) {
    std::pop_heap(heap.begin(), heap.end(), darker);
    const Group group = heap.back();
    heap.pop_back();
    if (group.end - group.begin < 2) {
      groups.push_back(group);
      continue;
    }
    const int middle = halve(atoms, order, group);
    for (const auto& [begin, end] : {std::pair{group.begin, middle}, std::pair{middle, group.end}}) {
      heap.push_back({begin, end, sum(begin, end)});
      std::push_heap(heap.begin(), heap.end(), darker);
    }
  }
  groups.insert(groups.end(), heap.begin(), heap.end());
  return groups;
}

}  // namespace

Atoms merge_atoms(const Atoms& atoms, int count) {
  if (atoms.count <= count) return atoms;
  std::vector<int> order(static_cast<std::size_t>(atoms.count));
  std::iota(order.begin(), order.end(), 0);
  const std::vector<Group> groups = divide(atoms, order, count);
  Atoms merged(static_cast<int>(groups.size()));
  merged.scale = atoms.scale;
  merged.total = atoms.total;
  for (const Group& group : groups) {
    Vec3d moment = Vec3d::Zero();
    Rgbd weight = Rgbd::Zero();
    double omega = 0;
    for (int k = group.begin; k < group.end; ++k) {
      const auto i = static_cast<std::size_t>(order[static_cast<std::size_t>(k)]);
      moment += static_cast<double>(atoms.luminance[i]) * atoms.direction(static_cast<int>(i));
      for (std::size_t c = 0; c < 3; ++c)
        weight[static_cast<Eigen::Index>(c)] += static_cast<double>(atoms.weight[c][i]);
      omega += static_cast<double>(atoms.solid_angle_sr[i]);
    }
    const double length = moment.norm();
    const Vec3d direction = length > 1e-9 * group.luminance
                                ? Vec3d(moment / length)
                                : atoms.direction(order[static_cast<std::size_t>(group.begin)]);
    merged.add(direction, weight, omega);
  }
  merged.finish();
  return merged;
}

}  // namespace lightwell
