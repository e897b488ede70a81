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

#include "render/grouped.h"
#include "render/surface_distance.h"

namespace lightwell::render {
namespace {

using Index = std::uint32_t;

constexpr Index kNone = std::numeric_limits<Index>::max();

Index count_of_corners(std::span<const Index> triangles) {
  return triangles.empty() ? 0 : *std::max_element(triangles.begin(), triangles.end()) + 1;
}

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
std::vector<Index> in_patches(std::span<const Index> triangles, std::span<const Vec3f> positions) {
  constexpr int kBits = 10;
  Vec3f low = positions[triangles[0]];
  Vec3f high = low;
  for (const Index i : triangles) {
    low = low.cwiseMin(positions[i]);
    high = high.cwiseMax(positions[i]);
  }
  // Doubles: the least and the largest extent of floats have a reciprocal and a difference, and none is times none.
  const Vec3d base = low.cast<double>();
  const double extent = (high.cast<double>() - base).maxCoeff();
  const double scale =
      ((1 << kBits) - 1) / std::max(extent, static_cast<double>(std::numeric_limits<float>::denorm_min()));
  std::vector<std::pair<Index, Index>> order;
  order.reserve(triangles.size() / 3);
  for (std::size_t t = 0; t < triangles.size(); t += 3) {
    const Vec3d at = (positions[triangles[t]].cast<double>() - base) * scale;
    Index code = 0;
    for (int bit = kBits - 1; bit >= 0; --bit)
      for (int i = 0; i < 3; ++i) code = code << 1 | (static_cast<Index>(at[i]) >> bit & 1);
    order.emplace_back(code, static_cast<Index>(t));
  }
  std::sort(order.begin(), order.end());
  std::vector<Index> ordered;
  ordered.reserve(triangles.size());
  for (const auto& [code, t] : order)
    for (Index c = 0; c < 3; ++c) ordered.push_back(triangles[t + c]);
  return ordered;
}

// Every edge is run along as often more in one direction than in the other by the triangles of both: what is closed with
// the one in it is closed with the other, though more than two triangles may meet at an edge.
bool have_one_border(std::span<const Index> a, std::span<const Index> b) {
  std::vector<std::pair<std::uint64_t, int>> edges;
  edges.reserve(a.size() + b.size());
  const auto add = [&](std::span<const Index> triangles, int sign) {
    for_each_edge(triangles, [&](Index from, Index to, Index) {
      edges.emplace_back(std::uint64_t{std::min(from, to)} << 32 | std::max(from, to),
                         from < to ? sign : -sign);
    });
  };
  add(a, 1);
  add(b, -1);
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size();) {
    int balance = 0;
    const std::uint64_t edge = edges[i].first;
    for (; i < edges.size() && edges[i].first == edge; ++i) balance += edges[i].second;
    if (balance != 0) return false;
  }
  return true;
}

// Patches of a surface: stretches of its triangles.
class Patches {
 public:
  Patches(std::span<const Index> triangles, std::span<const Vec3f> positions, std::size_t size)
      : triangles_(in_patches(triangles, positions)),
        positions_(positions),
        size_(size),
        of_corner_(positions.size(), [&](const auto& put) {
          for (std::size_t i = 0; i < triangles_.size(); ++i) put(triangles_[i], static_cast<Index>(i / 3));
        }) {}

  // All simplified, each with its borders kept. offset: of the first border, triangles
  [[nodiscard]] std::vector<Index> simplified(float max_distance_m, std::size_t offset,
                                              std::vector<Index>& place) const {
    std::vector<Index> all;
    for (std::size_t first = 0; first < triangles_.size();) {
      const std::size_t size = first == 0 && offset > 0 ? 3 * offset : size_;
      const auto patch = std::span(triangles_).subspan(first, std::min(size, triangles_.size() - first));
      simplify_into(all, patch, max_distance_m, place);
      first += patch.size();
    }
    return all;
  }

 private:
  // The library errs by far more than its mean in few places: halves find them. What fails in the smallest stays.
  void simplify_into(std::vector<Index>& all, std::span<const Index> patch, float max_distance_m,
                     std::vector<Index>& place) const {
    constexpr std::size_t kSmallest = 3 * 150;
    const auto bound_m = static_cast<double>(max_distance_m);
    const std::vector<Index> fewer = collapse(patch, positions_, max_distance_m * 0.4f, true, place);
    if (have_one_border(patch, fewer) && lies_within(patch, fewer, positions_, bound_m) &&
        lies_within(fewer, with_neighbours(patch), positions_, bound_m)) {
      all.insert(all.end(), fewer.begin(), fewer.end());
    } else if (patch.size() <= kSmallest) {
      all.insert(all.end(), patch.begin(), patch.end());
    } else {
      const std::size_t half = patch.size() / 6 * 3;
      simplify_into(all, patch.first(half), max_distance_m, place);
      simplify_into(all, patch.subspan(half), max_distance_m, place);
    }
  }

  // A border is jagged: what is simpler may leave the patch there, though not the surface.
  [[nodiscard]] std::vector<Index> with_neighbours(std::span<const Index> patch) const {
    const auto first = static_cast<Index>((patch.data() - triangles_.data()) / 3);
    const auto end = static_cast<Index>(first + patch.size() / 3);
    std::vector<Index> corners(patch.begin(), patch.end());  // each once: of a fan, one is every triangle's
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    std::vector<Index> outside;
    for (const Index corner : corners)
      for (const Index t : of_corner_.of(corner))
        if (t < first || t >= end) outside.push_back(t);
    std::sort(outside.begin(), outside.end());
    outside.erase(std::unique(outside.begin(), outside.end()), outside.end());
    std::vector<Index> all(patch.begin(), patch.end());
    for (const Index t : outside)
      for (std::size_t c = 0; c < 3; ++c) all.push_back(triangles_[3 * t + c]);
    return all;
  }

  std::vector<Index> triangles_;
  std::span<const Vec3f> positions_;
  std::size_t size_;
  Groups<Index> of_corner_;
};

// A large mesh costs more than its parts, whose memory is near: patches go, in rounds, as their borders cannot go before
// they lie within another patch. Each round takes a share of the distance: surfaces a and b apart, and b and c, are no more
// than the sum apart.
std::vector<Index> simplify_by_patches(const Piece& piece, float max_distance_m, std::vector<Index>& place) {
  constexpr std::size_t kPatch = 8'000;  // triangles
  std::vector<Index> triangles = piece.triangles;
  float left_m = max_distance_m;
  for (const float share : {0.25f, 1.0f}) {
    const float share_m = share * left_m;
    left_m -= share_m;
    const Patches patches(triangles, piece.positions, 3 * kPatch);
    triangles = patches.simplified(share_m, share < 1 ? 0 : kPatch / 2, place);
  }
  return triangles;
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

std::vector<Index> simplify_piece(const Piece& piece, float max_distance_m, float spent_m) {
  const bool closed = is_closed(piece.triangles);
  const Size size = size_of(piece.triangles, piece.positions);
  // Volume over surface is half a bar's radius, half a plate's thickness.
  if (closed)
    max_distance_m =
        std::min(max_distance_m, static_cast<float>(std::abs(size.volume_m3) / size.area_m2 / 4));
  max_distance_m -= spent_m;
  if (!(max_distance_m > 0)) return piece.triangles;
  // The library bounds a mean of distances, edge by edge; what is asked is a bound on the largest. So it is given
  // less and less until the result keeps to it.
  constexpr int kAttempts = 12;
  constexpr float kLess = 0.85f;
  constexpr std::size_t kLarge = 3 * 20'000;
  std::vector<Index> place(piece.positions.size(), kNone);
  if (piece.triangles.size() > kLarge) {
    std::vector<Index> fewer = simplify_by_patches(piece, max_distance_m, place);
    return !closed || has_no_border(fewer) ? fewer : piece.triangles;
  }
  float target = max_distance_m;
  std::vector<Index> second_best = piece.triangles;
  for (int attempt = 0; attempt < kAttempts; ++attempt, target *= kLess) {
    std::vector<Index> fewer = collapse(piece.triangles, piece.positions, target, !closed, place);
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

std::vector<Index> simplify(std::span<const Index> triangles, std::span<const Vec3f> positions,
                            float max_distance_m, float spent_m) {
  std::vector<Index> result;
  for (const Piece& piece : pieces_of(triangles, positions))
    for (const Index i : simplify_piece(piece, max_distance_m, spent_m)) result.push_back(piece.origin[i]);
  return result;
}

}  // namespace lightwell::render
