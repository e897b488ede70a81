// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/caster_mesh.h"

#include <meshoptimizer.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace lightwell::render {
namespace {

using Index = std::uint32_t;

constexpr Index kNone = std::numeric_limits<Index>::max();

Index count_of_corners(std::span<const Index> triangles) {
  return triangles.empty() ? 0 : *std::max_element(triangles.begin(), triangles.end()) + 1;
}

// Values grouped by a key below keys: those of key k are values[starts[k]] to values[starts[k + 1]], in their order.
template <class Value>
struct Groups {
  std::vector<std::size_t> starts;
  std::vector<Value> values;

  // each(put) calls put(key, value) for every pair, the same ones each of the two times it is called.
  template <class Each>
  Groups(std::size_t keys, const Each& each) : starts(keys + 1, 0) {
    each([&](std::size_t key, const Value&) { ++starts[key + 1]; });
    std::partial_sum(starts.begin(), starts.end(), starts.begin());
    values.resize(starts.back());
    std::vector<std::size_t> next(starts.begin(), starts.end() - 1);
    each([&](std::size_t key, const Value& value) { values[next[key]++] = value; });
  }
  [[nodiscard]] std::span<const Value> of(std::size_t key) const {
    return std::span(values).subspan(starts[key], starts[key + 1] - starts[key]);
  }
  void sort() {
    for (std::size_t k = 0; k + 1 < starts.size(); ++k)
      std::sort(values.begin() + static_cast<std::ptrdiff_t>(starts[k]),
                values.begin() + static_cast<std::ptrdiff_t>(starts[k + 1]));
  }
};

template <class Visit>
void for_each_edge(std::span<const Index> triangles, const Visit& visit) {
  for (std::size_t i = 0; i < triangles.size(); ++i)
    visit(triangles[i], triangles[i % 3 == 2 ? i - 2 : i + 1], static_cast<Index>(i / 3));
}

struct Piece {
  std::vector<Vec3f> positions;
  std::vector<Index> origin;  // of each position, in the whole mesh
  std::vector<Index> triangles;
};

// A number for each triangle; those that share an edge, or are joined by such, have the same.
std::vector<Index> connected(std::span<const Index> triangles, Index corners) {
  std::vector<Index> parent(triangles.size() / 3);
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](Index t) {
    while (parent[t] != t) t = parent[t] = parent[parent[t]];
    return t;
  };
  Groups<std::pair<Index, Index>> edges(corners, [&](const auto& put) {
    for_each_edge(triangles,
                  [&](Index a, Index b, Index t) { put(std::min(a, b), std::pair(std::max(a, b), t)); });
  });
  edges.sort();
  for (Index a = 0; a < corners; ++a) {
    const auto group = edges.of(a);
    for (std::size_t i = 1; i < group.size(); ++i)
      if (group[i].first == group[i - 1].first) parent[root(group[i].second)] = root(group[i - 1].second);
  }
  std::vector<Index> number(parent.size(), kNone);
  Index count = 0;
  for (Index t = 0; t < parent.size(); ++t) {
    const Index r = root(t);
    if (number[r] == kNone) number[r] = count++;
    if (r != t) number[t] = number[r];
  }
  return number;
}

// Triangles that share an edge are of one piece.
std::vector<Piece> pieces_of(std::span<const Index> triangles, std::span<const Vec3f> positions) {
  const Index corners = count_of_corners(triangles);
  const std::vector<Index> number = connected(triangles, corners);
  const std::size_t count = number.empty() ? 0 : *std::max_element(number.begin(), number.end()) + 1u;
  const Groups<Index> of_piece(count, [&](const auto& put) {
    for (Index t = 0; t < number.size(); ++t) put(number[t], t);
  });
  std::vector<Piece> pieces(count);
  std::vector<Index> place(corners, kNone);
  for (std::size_t p = 0; p < count; ++p) {
    Piece& piece = pieces[p];
    for (const Index t : of_piece.of(p))
      for (std::size_t c = 0; c < 3; ++c) {
        const Index corner = triangles[3 * t + c];
        if (place[corner] == kNone) {
          place[corner] = static_cast<Index>(piece.positions.size());
          piece.positions.push_back(positions[corner]);
          piece.origin.push_back(corner);
        }
        piece.triangles.push_back(place[corner]);
      }
    for (const Index corner : piece.origin) place[corner] = kNone;
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

using Corners = std::array<Vec3d, 3>;

Corners corners_of(std::span<const Index> triangles, std::size_t t, std::span<const Vec3f> positions) {
  return {positions[triangles[3 * t]].cast<double>(), positions[triangles[3 * t + 1]].cast<double>(),
          positions[triangles[3 * t + 2]].cast<double>()};
}

// Which triangles of a surface are within a distance of a point, by a grid of cells.
class Neighbourhood {
 public:
  Neighbourhood(std::span<const Index> triangles, std::span<const Vec3f> positions, double reach_m)
      : triangles_(triangles),
        positions_(positions),
        reach_m_(reach_m),
        low_(box_of(triangles, positions).first),
        cells_(grid()) {}

  // Every point of the triangle is within reach of the surface. Distance to one flat triangle is convex: where
  // it holds of the corners, it holds of all between. Where the corners are near different triangles, quarters
  // are asked; after kQuarterings of them the answer is no.
  [[nodiscard]] bool contains(const Corners& t, int quarterings = 0) const {
    constexpr int kQuarterings = 7;
    const auto c = cell(t[0]);
    for (int i = 0; i < 3; ++i)
      if (c[static_cast<std::size_t>(i)] < 0 ||
          c[static_cast<std::size_t>(i)] >= size_[static_cast<std::size_t>(i)])
        return false;
    // No point of the triangle is farther from its first corner than the farther of the others.
    const double size = std::sqrt(std::max((t[1] - t[0]).squaredNorm(), (t[2] - t[0]).squaredNorm()));
    bool near_corner = false;
    const auto holds = [&](Index i) {
      if (!in_box(t[0], i)) return false;
      const Corners other = corners_of(triangles_, i, positions_);
      const double distance = distance_to_triangle(t[0], other);
      near_corner = near_corner || distance <= reach_m_;
      return distance + size <= reach_m_ ||
             (distance <= reach_m_ && distance_to_triangle(t[1], other) <= reach_m_ &&
              distance_to_triangle(t[2], other) <= reach_m_);
    };
    // What was near the last one is often near this one.
    if (holds(last_)) return true;
    for (const Index i : cells_.of(key(c))) {
      if (!holds(i)) continue;
      last_ = i;
      return true;
    }
    if (!near_corner || quarterings == kQuarterings) return false;
    const Corners middle = {(t[0] + t[1]) / 2, (t[1] + t[2]) / 2, (t[2] + t[0]) / 2};
    return contains({t[0], middle[0], middle[2]}, quarterings + 1) &&
           contains({t[1], middle[1], middle[0]}, quarterings + 1) &&
           contains({t[2], middle[2], middle[1]}, quarterings + 1) && contains(middle, quarterings + 1);
  }

 private:
  using Cell = std::array<std::int64_t, 3>;

  static std::pair<Vec3d, Vec3d> box_of(std::span<const Index> triangles, std::span<const Vec3f> positions) {
    Vec3f low = positions[triangles[0]];
    Vec3f high = low;
    for (const Index i : triangles) {
      low = low.cwiseMin(positions[i]);
      high = high.cwiseMax(positions[i]);
    }
    return {low.cast<double>(), high.cast<double>()};
  }

  // Within reach of the triangle's box, which is quickly seen.
  [[nodiscard]] bool in_box(const Vec3d& p, Index t) const {
    const Vec3f& a = positions_[triangles_[3 * t]];
    const Vec3f& b = positions_[triangles_[3 * t + 1]];
    const Vec3f& c = positions_[triangles_[3 * t + 2]];
    for (int i = 0; i < 3; ++i)
      if (p[i] < static_cast<double>(std::min({a[i], b[i], c[i]})) - reach_m_ ||
          p[i] > static_cast<double>(std::max({a[i], b[i], c[i]})) + reach_m_)
        return false;
    return true;
  }

  // A surface through a cube of n³ cells fills about 6 n² of them: a few triangles in each.
  Groups<Index> grid() {
    const double cells = std::clamp(std::sqrt(static_cast<double>(triangles_.size()) / 3 / 12), 16.0, 200.0);
    const auto [low, high] = box_of(triangles_, positions_);
    cell_m_ = std::max({reach_m_, (high - low).maxCoeff() / cells, std::numeric_limits<double>::min()});
    low_ = low.array() - reach_m_;
    size_ = {1, 1, 1};
    const Cell last = cell(high.array() + reach_m_);
    for (std::size_t i = 0; i < 3; ++i) size_[i] = last[i] + 1;
    return Groups<Index>(static_cast<std::size_t>(size_[0] * size_[1] * size_[2]), [&](const auto& put) {
      for (std::size_t t = 0; t < triangles_.size() / 3; ++t) {
        const Corners c = corners_of(triangles_, t, positions_);
        const Cell from = cell(c[0].cwiseMin(c[1]).cwiseMin(c[2]).array() - reach_m_);
        const Cell to = cell(c[0].cwiseMax(c[1]).cwiseMax(c[2]).array() + reach_m_);
        for (auto x = from[0]; x <= to[0]; ++x)
          for (auto y = from[1]; y <= to[1]; ++y)
            for (auto z = from[2]; z <= to[2]; ++z) put(key({x, y, z}), static_cast<Index>(t));
      }
    });
  }

  [[nodiscard]] Cell cell(const Vec3d& p) const {
    Cell c{};
    for (int i = 0; i < 3; ++i)
      c[static_cast<std::size_t>(i)] = static_cast<std::int64_t>(std::floor((p[i] - low_[i]) / cell_m_));
    return c;
  }
  [[nodiscard]] std::size_t key(const Cell& c) const {
    return static_cast<std::size_t>((c[0] * size_[1] + c[1]) * size_[2] + c[2]);
  }

  std::span<const Index> triangles_;
  std::span<const Vec3f> positions_;
  double reach_m_;
  double cell_m_ = 1;
  Vec3d low_;
  Cell size_{};
  Groups<Index> cells_;
  mutable Index last_ = 0;  // triangle that the last answer rested on
};

bool lies_within(std::span<const Index> triangles, std::span<const Index> of,
                 std::span<const Vec3f> positions, double distance_m) {
  const Neighbourhood near(of, positions, distance_m);
  for (std::size_t t = 0; t < triangles.size() / 3; ++t)
    if (!near.contains(corners_of(triangles, t, positions))) return false;
  return true;
}

// What the library makes of it; target_m: its mean of distances. Looks at no positions but those in use.
// place: kNone for every position, as it is left.
std::vector<Index> collapse(std::span<const Index> triangles, std::span<const Vec3f> positions,
                            float target_m, bool lock_borders, std::vector<Index>& place) {
  std::vector<Vec3f> used;
  std::vector<Index> origin;
  std::vector<Index> compact;
  compact.reserve(triangles.size());
  for (const Index i : triangles) {
    if (place[i] == kNone) {
      place[i] = static_cast<Index>(origin.size());
      origin.push_back(i);
      used.push_back(positions[i]);
    }
    compact.push_back(place[i]);
  }
  for (const Index i : origin) place[i] = kNone;
  const float* data = used[0].data();
  const float scale = meshopt_simplifyScale(data, used.size(), sizeof(Vec3f));
  std::vector<Index> fewer(compact.size());
  fewer.resize(meshopt_simplify(fewer.data(), compact.data(), compact.size(), data, used.size(),
                                sizeof(Vec3f), 0, target_m / scale,
                                lock_borders ? meshopt_SimplifyLockBorder : 0, nullptr));
  for (Index& i : fewer) i = origin[i];
  return fewer;
}

// Triangles in the order of a curve that keeps to one place for long (Morton's), so that stretches of it are patches.
std::vector<Index> in_patches(const Piece& piece) {
  constexpr int kBits = 10;
  Vec3f low = piece.positions[0];
  Vec3f high = low;
  for (const Vec3f& p : piece.positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const float scale =
      ((1 << kBits) - 1) / std::max((high - low).maxCoeff(), std::numeric_limits<float>::min());
  std::vector<std::pair<Index, Index>> order;
  order.reserve(piece.triangles.size() / 3);
  for (std::size_t t = 0; t < piece.triangles.size(); t += 3) {
    const Vec3f at = (piece.positions[piece.triangles[t]] - low) * scale;
    Index code = 0;
    for (int bit = kBits - 1; bit >= 0; --bit)
      for (int i = 0; i < 3; ++i) code = code << 1 | (static_cast<Index>(at[i]) >> bit & 1);
    order.emplace_back(code, static_cast<Index>(t));
  }
  std::sort(order.begin(), order.end());
  std::vector<Index> triangles;
  triangles.reserve(piece.triangles.size());
  for (const auto& [code, t] : order)
    for (Index c = 0; c < 3; ++c) triangles.push_back(piece.triangles[t + c]);
  return triangles;
}

// The library's time for a large mesh is that of memory far apart: patches of it, with their borders kept, go first.
std::vector<Index> collapse_patches(const Piece& piece, float target_m, std::vector<Index>& place) {
  constexpr std::size_t kPatch = 3 * 50'000;
  const std::vector<Index> triangles = in_patches(piece);
  std::vector<Index> result;
  for (std::size_t first = 0; first < triangles.size(); first += kPatch) {
    const auto patch = std::span(triangles).subspan(first, std::min(kPatch, triangles.size() - first));
    const std::vector<Index> fewer = collapse(patch, piece.positions, target_m, true, place);
    result.insert(result.end(), fewer.begin(), fewer.end());
  }
  return result;
}

// Every edge is run along as often in one direction as in the other: no light finds a way in, though more than two
// triangles may meet at an edge.
bool has_no_border(std::span<const Index> triangles) {
  Groups<Index> next(count_of_corners(triangles), [&](const auto& put) {
    for_each_edge(triangles, [&](Index a, Index b, Index) { put(a, b); });
  });
  next.sort();
  for (std::size_t a = 0; a + 1 < next.starts.size(); ++a)
    for (const Index b : next.of(a)) {
      const auto times = [](const auto& sorted, Index value) {
        const auto [first, last] = std::equal_range(sorted.begin(), sorted.end(), value);
        return last - first;
      };
      if (times(next.of(a), b) != times(next.of(b), static_cast<Index>(a))) return false;
    }
  return true;
}

std::vector<Index> simplify_piece(const Piece& piece, float max_distance_m) {
  const bool closed = is_closed(piece.triangles);
  const Size size = size_of(piece.triangles, piece.positions);
  // Volume over surface is half a bar's radius, half a plate's thickness.
  if (closed)
    max_distance_m =
        std::min(max_distance_m, static_cast<float>(std::abs(size.volume_m3) / size.area_m2 / 4));
  if (!(max_distance_m > 0)) return piece.triangles;
  // The library bounds a mean of distances, edge by edge; what is asked is a bound on the largest. So it is given
  // less and less until the result keeps to it.
  constexpr int kAttempts = 12;
  constexpr float kLess = 0.85f;
  // Where patches go first, they take a share of the distance.
  constexpr std::size_t kLarge = 3 * 200'000;
  constexpr float kPatchShare = 0.25f;
  std::vector<Index> place(piece.positions.size(), kNone);
  const bool large = piece.triangles.size() > kLarge;
  const std::vector<Index> begin =
      large ? collapse_patches(piece, kPatchShare * max_distance_m, place) : piece.triangles;
  // What is checked against very many triangles begins nearer to where it holds.
  float target = large ? max_distance_m / 2 : max_distance_m;
  std::vector<Index> second_best = piece.triangles;
  for (int attempt = 0; attempt < kAttempts; ++attempt, target *= kLess) {
    std::vector<Index> fewer = collapse(begin, piece.positions, target, !closed, place);
    if (fewer.empty() || fewer.size() >= second_best.size()) continue;
    const bool stays_closed = !closed || is_closed(fewer);
    if (!stays_closed && !has_no_border(fewer)) continue;
    if (!stay_together(piece.triangles, fewer, piece.positions, static_cast<double>(max_distance_m)))
      continue;
    if (stays_closed) return fewer;
    second_best = std::move(fewer);
  }
  return second_best;
}

}  // namespace

bool is_closed(std::span<const Index> triangles) {
  Groups<Index> next(count_of_corners(triangles), [&](const auto& put) {
    for_each_edge(triangles, [&](Index a, Index b, Index) { put(a, b); });
  });
  next.sort();
  for (std::size_t a = 0; a + 1 < next.starts.size(); ++a) {
    const auto ends = next.of(a);
    if (std::adjacent_find(ends.begin(), ends.end()) != ends.end()) return false;
    for (const Index b : ends) {
      const auto back = next.of(b);
      if (!std::binary_search(back.begin(), back.end(), static_cast<Index>(a))) return false;
    }
  }
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
