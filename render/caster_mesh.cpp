// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/caster_mesh.h"

#include <meshoptimizer.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <unordered_map>

namespace lightwell::render {
namespace {

using Index = std::uint32_t;

std::uint64_t edge_key(Index a, Index b) {
  return (static_cast<std::uint64_t>(a) << 32) | b;
}

struct Piece {
  std::vector<Vec3f> positions;
  std::vector<Index> origin;  // of each position, in the whole mesh
  std::vector<Index> triangles;
};

// Triangles that share an edge are of one piece.
std::vector<Piece> pieces_of(std::span<const Index> triangles, std::span<const Vec3f> positions) {
  std::vector<Index> parent(triangles.size() / 3);
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](Index t) {
    while (parent[t] != t) t = parent[t] = parent[parent[t]];
    return t;
  };
  std::unordered_map<std::uint64_t, Index> first_at_edge;
  first_at_edge.reserve(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Index a = triangles[i];
    const Index b = triangles[i % 3 == 2 ? i - 2 : i + 1];
    const auto t = static_cast<Index>(i / 3);
    const auto [other, is_new] = first_at_edge.try_emplace(edge_key(std::min(a, b), std::max(a, b)), t);
    if (!is_new) parent[root(t)] = root(other->second);
  }
  std::vector<Piece> pieces;
  std::unordered_map<Index, std::size_t> piece_of_root;
  std::vector<std::unordered_map<Index, Index>> local;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto [place, is_new] = piece_of_root.try_emplace(root(static_cast<Index>(i / 3)), pieces.size());
    if (is_new) pieces.emplace_back(), local.emplace_back();
    Piece& piece = pieces[place->second];
    const auto [corner, is_new_corner] =
        local[place->second].try_emplace(triangles[i], static_cast<Index>(piece.positions.size()));
    if (is_new_corner) {
      piece.positions.push_back(positions[triangles[i]]);
      piece.origin.push_back(triangles[i]);
    }
    piece.triangles.push_back(corner->second);
  }
  return pieces;
}

struct Size {
  double volume_m3 = 0;
  double area_m2 = 0;
};

Size size_of(std::span<const Index> triangles, std::span<const Vec3f> positions) {
  Size size;
  const Vec3d base = positions[triangles[0]].cast<double>();
  for (std::size_t t = 0; t < triangles.size(); t += 3) {
    const Vec3d a = positions[triangles[t]].cast<double>() - base;
    const Vec3d b = positions[triangles[t + 1]].cast<double>() - base;
    const Vec3d c = positions[triangles[t + 2]].cast<double>() - base;
    size.volume_m3 += a.dot(b.cross(c)) / 6;
    size.area_m2 += (b - a).cross(c - a).norm() / 2;
  }
  return size;
}

double distance_to_segment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d along = b - a;
  const double squared = along.squaredNorm();
  const double t = squared > 0 ? std::clamp((p - a).dot(along) / squared, 0.0, 1.0) : 0;
  return (a + t * along - p).norm();
}

double distance_to_triangle(const Vec3d& p, const std::array<Vec3d, 3>& t) {
  const Vec3d n = (t[1] - t[0]).cross(t[2] - t[0]);
  const double squared = n.squaredNorm();
  bool above = squared > 0;
  for (std::size_t e = 0; e < 3 && above; ++e) above = n.dot((t[(e + 1) % 3] - t[e]).cross(p - t[e])) >= 0;
  if (above) return std::abs(n.dot(p - t[0])) / std::sqrt(squared);
  return std::min({distance_to_segment(p, t[0], t[1]), distance_to_segment(p, t[1], t[2]),
                   distance_to_segment(p, t[2], t[0])});
}

// Which triangles of a surface are within a distance of a point, by a grid of cells.
class Neighbourhood {
 public:
  Neighbourhood(std::span<const Index> triangles, std::span<const Vec3f> positions, double reach_m)
      : reach_m_(reach_m) {
    Vec3d low = positions[triangles[0]].cast<double>();
    Vec3d high = low;
    for (const Index i : triangles) {
      low = low.cwiseMin(positions[i].cast<double>());
      high = high.cwiseMax(positions[i].cast<double>());
    }
    // Cells along the longest side: a few triangles in each of those that a surface passes, where it has many.
    const double cells = std::clamp(std::sqrt(static_cast<double>(triangles.size())) / 2, 1.0, 64.0);
    cell_m_ = std::max(reach_m, (high - low).maxCoeff() / cells);
    for (std::size_t t = 0; t < triangles.size(); t += 3) {
      auto& corners = triangles_.emplace_back();
      for (std::size_t c = 0; c < 3; ++c) corners[c] = positions[triangles[t + c]].cast<double>();
      const auto from = cell(corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]).array() - reach_m);
      const auto to = cell(corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]).array() + reach_m);
      for (auto x = from[0]; x <= to[0]; ++x)
        for (auto y = from[1]; y <= to[1]; ++y)
          for (auto z = from[2]; z <= to[2]; ++z) cells_[key({x, y, z})].push_back(triangles_.size() - 1);
    }
  }

  // Every point of the triangle is within reach of the surface. Distance to one flat triangle is convex: where
  // it holds of the corners, it holds of all between. Where the corners are near different triangles, quarters
  // are asked; after kQuarterings of them the answer is no.
  [[nodiscard]] bool contains(const std::array<Vec3d, 3>& t, int quarterings = 0) const {
    constexpr int kQuarterings = 7;
    const auto place = cells_.find(key(cell(t[0])));
    if (place == cells_.end()) return false;
    bool near_corner = false;
    for (const std::size_t i : place->second) {
      if (distance_to_triangle(t[0], triangles_[i]) > reach_m_) continue;
      near_corner = true;
      if (distance_to_triangle(t[1], triangles_[i]) <= reach_m_ &&
          distance_to_triangle(t[2], triangles_[i]) <= reach_m_)
        return true;
    }
    if (!near_corner || quarterings == kQuarterings) return false;
    const std::array<Vec3d, 3> middle = {(t[0] + t[1]) / 2, (t[1] + t[2]) / 2, (t[2] + t[0]) / 2};
    return contains({t[0], middle[0], middle[2]}, quarterings + 1) &&
           contains({t[1], middle[1], middle[0]}, quarterings + 1) &&
           contains({t[2], middle[2], middle[1]}, quarterings + 1) && contains(middle, quarterings + 1);
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  [[nodiscard]] Cell cell(const Vec3d& p) const {
    Cell c{};
    for (int i = 0; i < 3; ++i)
      c[static_cast<std::size_t>(i)] = static_cast<std::int64_t>(std::floor(p[i] / cell_m_));
    return c;
  }
  // 21 bits each: cells farther apart than a million share a list, which is only longer for it.
  static std::uint64_t key(const Cell& c) {
    std::uint64_t k = 0;
    for (const std::int64_t i : c) k = k << 21 | (static_cast<std::uint64_t>(i) & 0x1fffff);
    return k;
  }

  double reach_m_;
  double cell_m_ = 1;
  std::vector<std::array<Vec3d, 3>> triangles_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> cells_;
};

bool lies_within(std::span<const Index> triangles, std::span<const Index> of,
                 std::span<const Vec3f> positions, double distance_m) {
  const Neighbourhood near(of, positions, distance_m);
  for (std::size_t t = 0; t < triangles.size(); t += 3)
    if (!near.contains({positions[triangles[t]].cast<double>(), positions[triangles[t + 1]].cast<double>(),
                        positions[triangles[t + 2]].cast<double>()}))
      return false;
  return true;
}

std::vector<Index> simplify_piece(const Piece& piece, float max_distance_m) {
  const bool closed = is_closed(piece.triangles);
  const Size size = size_of(piece.triangles, piece.positions);
  const float* data = piece.positions[0].data();
  const float scale = meshopt_simplifyScale(data, piece.positions.size(), sizeof(Vec3f));
  // Volume over surface is half a bar's radius, half a plate's thickness.
  if (closed)
    max_distance_m =
        std::min(max_distance_m, static_cast<float>(std::abs(size.volume_m3) / size.area_m2 / 4));
  if (!(max_distance_m > 0)) return piece.triangles;
  // The library bounds a mean of distances, edge by edge; what is asked is a bound on the largest. So it is given
  // less and less until the result keeps to it.
  constexpr int kAttempts = 12;
  constexpr float kLess = 0.85f;
  float target = max_distance_m;
  for (int attempt = 0; attempt < kAttempts; ++attempt, target *= kLess) {
    std::vector<Index> fewer(piece.triangles.size());
    fewer.resize(meshopt_simplify(fewer.data(), piece.triangles.data(), piece.triangles.size(), data,
                                  piece.positions.size(), sizeof(Vec3f), 0, target / scale,
                                  closed ? 0 : meshopt_SimplifyLockBorder, nullptr));
    if (fewer.empty() || (closed && !is_closed(fewer))) continue;
    if (stay_together(piece.triangles, fewer, piece.positions, max_distance_m)) return fewer;
  }
  return piece.triangles;
}

}  // namespace

bool is_closed(std::span<const Index> triangles) {
  std::unordered_map<std::uint64_t, int> edges;
  for (std::size_t t = 0; t < triangles.size(); t += 3)
    for (std::size_t e = 0; e < 3; ++e)
      if (++edges[edge_key(triangles[t + e], triangles[t + (e + 1) % 3])] > 1) return false;
  for (const auto& [edge, count] : edges)
    if (!edges.contains(edge_key(static_cast<Index>(edge), static_cast<Index>(edge >> 32)))) return false;
  return !triangles.empty();
}

bool stay_together(std::span<const Index> a, std::span<const Index> b, std::span<const Vec3f> positions,
                   double distance_m) {
  return a.empty() || b.empty()
             ? a.size() == b.size()
             : lies_within(a, b, positions, distance_m) && lies_within(b, a, positions, distance_m);
}

std::vector<Index> simplify(std::span<const Index> triangles, std::span<const Vec3f> positions,
                            float max_distance_m) {
  std::vector<Index> result;
  for (const Piece& piece : pieces_of(triangles, positions))
    for (const Index i : simplify_piece(piece, max_distance_m)) result.push_back(piece.origin[i]);
  return result;
}

}  // namespace lightwell::render
