// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/surface_distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "lighting/result.h"
#include "render/grouped.h"

namespace lightwell::render {
namespace {

using Index = std::uint32_t;

// Convex and flat: what is left of a triangle.
struct Polygon {
  static constexpr int kMost = 24;
  std::array<Vec3d, kMost> corners;
  int count = 0;

  Polygon() = default;
  Polygon(const Polygon& other) : count(other.count) {
    std::copy_n(other.corners.begin(), count, corners.begin());
  }
  Polygon& operator=(const Polygon& other) {
    count = other.count;
    std::copy_n(other.corners.begin(), count, corners.begin());
    return *this;
  }
  void add(const Vec3d& p) {
    verify_bug(count < kMost, "a polygon of more corners than cuts can make");
    corners[static_cast<std::size_t>(count++)] = p;
  }
  [[nodiscard]] const Vec3d& operator[](int i) const { return corners[static_cast<std::size_t>(i)]; }
  [[nodiscard]] Vec3d middle() const {
    Vec3d sum = Vec3d::Zero();
    for (int i = 0; i < count; ++i) sum += (*this)[i];
    return sum / count;
  }
};

double squared_distance_to_segment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d along = b - a;
  const double squared = along.squaredNorm();
  const double t = squared > 0 ? std::clamp((p - a).dot(along) / squared, 0.0, 1.0) : 0;
  return (a + t * along - p).squaredNorm();
}

// A triangle and the planes that bound the prism of all points above and below it.
struct Prism {
  std::array<Vec3d, 3> corners;
  Vec3d low, high;
  Vec3d normal = Vec3d::Zero();   // zero: the triangle has no area
  std::array<Vec3d, 3> inward{};  // unit, in its plane, of the edge from a corner to the next

  explicit Prism(const std::array<Vec3d, 3>& c) : corners(c) {
    low = c[0].cwiseMin(c[1]).cwiseMin(c[2]);
    high = c[0].cwiseMax(c[1]).cwiseMax(c[2]);
    const Vec3d n = (c[1] - c[0]).cross(c[2] - c[0]);
    const double length = n.norm();
    if (!(length > 0)) return;
    normal = n / length;
    for (std::size_t e = 0; e < 3; ++e) inward[e] = normal.cross(c[(e + 1) % 3] - c[e]).normalized();
  }
  [[nodiscard]] bool has_area() const { return normal.squaredNorm() > 0; }
  [[nodiscard]] double height(const Vec3d& p) const { return normal.dot(p - corners[0]); }
  // Of an edge's plane, positive inside.
  [[nodiscard]] double inside(std::size_t edge, const Vec3d& p) const {
    return inward[edge].dot(p - corners[edge]);
  }
  [[nodiscard]] bool contains(const Vec3d& p) const {
    return inside(0, p) >= 0 && inside(1, p) >= 0 && inside(2, p) >= 0;
  }
  [[nodiscard]] bool is_within(const Vec3d& p, double reach) const {
    for (int i = 0; i < 3; ++i)
      if (p[i] < low[i] - reach || p[i] > high[i] + reach) return false;
    if (has_area()) {
      if (std::abs(height(p)) > reach) return false;
      if (contains(p)) return true;
    }
    const double squared = reach * reach;
    // Beyond an edge only it and its corners are near.
    return squared_distance_to_segment(p, corners[0], corners[1]) <= squared ||
           squared_distance_to_segment(p, corners[1], corners[2]) <= squared ||
           squared_distance_to_segment(p, corners[2], corners[0]) <= squared;
  }
  // What is so near is convex: where it holds of the corners, it holds of all between.
  [[nodiscard]] bool is_within(const Polygon& polygon, double reach) const {
    for (int i = 0; i < polygon.count; ++i)
      if (!is_within(polygon[i], reach)) return false;
    return true;
  }
};

std::array<Vec3d, 3> corners_of(std::span<const Index> triangles, std::size_t t,
                                std::span<const Vec3f> positions) {
  return {positions[triangles[3 * t]].cast<double>(), positions[triangles[3 * t + 1]].cast<double>(),
          positions[triangles[3 * t + 2]].cast<double>()};
}

// Into the part where side(p) ≥ 0, and the rest; corners so near to the plane belong to both.
template <class Side>
void cut(Polygon& polygon, Polygon& rest, double near, const Side& side) {
  std::array<double, Polygon::kMost> s{};
  bool any_out = false;
  for (int i = 0; i < polygon.count; ++i) {
    s[static_cast<std::size_t>(i)] = side(polygon[i]);
    any_out = any_out || s[static_cast<std::size_t>(i)] < -near;
  }
  if (!any_out) return;
  Polygon in;
  for (int i = 0; i < polygon.count; ++i) {
    const int next = i + 1 < polygon.count ? i + 1 : 0;
    const double a = s[static_cast<std::size_t>(i)];
    const double b = s[static_cast<std::size_t>(next)];
    if (a >= -near) in.add(polygon[i]);
    if (a <= near) rest.add(polygon[i]);
    if ((a > near && b < -near) || (a < -near && b > near)) {
      const Vec3d p = polygon[i] + a / (a - b) * (polygon[next] - polygon[i]);
      in.add(p);
      rest.add(p);
    }
  }
  polygon = in;
}

// Which points are within reach of a surface, by a grid of cells.
class Neighbourhood {
 public:
  Neighbourhood(std::span<const Index> triangles, std::span<const Vec3f> positions, double reach_m)
      : reach_m_(reach_m), near_m_(1e-6 * reach_m), prisms_(prisms(triangles, positions)), cells_(grid()) {}

  // Every point of the triangle is within reach.
  [[nodiscard]] bool contains(const std::array<Vec3d, 3>& triangle) {
    Polygon polygon;
    for (const Vec3d& p : triangle) polygon.add(p);
    constexpr int kMostPieces = 5000;
    pieces_left_ = kMostPieces;
    return contains(polygon, 0);
  }

 private:
  using Cell = std::array<std::int64_t, 3>;

  // A cut adds one, and a few where rounding bends an edge.
  static constexpr int kMostCorners = 9;
  static constexpr int kDeepest = 100;

  // Where one triangle is near to all of the polygon, the answer is yes. Else what lies in the prism of one is asked of that
  // one alone, and the rest goes on; where there is no such prism, halves do.
  [[nodiscard]] bool contains(const Polygon& polygon, int depth) {
    if (polygon.count < 3) return true;  // without area, and the border of another piece
    if (--pieces_left_ < 0 || depth > kDeepest || polygon.count > kMostCorners) return false;
    if (prisms_[last_].is_within(polygon, reach_m_)) return true;
    const Vec3d middle = polygon.middle();
    const bool may_grow = polygon.count < kMostCorners;
    if (may_grow && is_over(prisms_[last_], middle)) return contains_over(polygon, middle, depth);
    const auto c = cell(middle);
    for (std::size_t i = 0; i < 3; ++i)
      if (c[i] < 0 || c[i] >= size_[i]) return false;
    const auto candidates = cells_.of(key(c));
    const auto over = std::find_if(candidates.begin(), candidates.end(),
                                   [&](Index i) { return is_over(prisms_[i], middle); });
    if (may_grow && over != candidates.end()) {
      last_ = *over;
      return prisms_[last_].is_within(polygon, reach_m_) || contains_over(polygon, middle, depth);
    }
    bool is_near = false;
    for (const Index i : candidates) {
      if (!prisms_[i].is_within(middle, reach_m_)) continue;
      is_near = true;
      if (!prisms_[i].is_within(polygon, reach_m_)) continue;
      last_ = i;
      return true;
    }
    return is_near && contains_halves(polygon, middle, depth);
  }

  [[nodiscard]] bool is_over(const Prism& prism, const Vec3d& p) const {
    return prism.has_area() && std::abs(prism.height(p)) <= reach_m_ && prism.contains(p);
  }

  // The last prism is over its middle.
  [[nodiscard]] bool contains_over(const Polygon& polygon, const Vec3d& middle, int depth) {
    const Prism& over = prisms_[last_];
    std::array<Polygon, 3> rest;
    Polygon left = polygon;
    for (std::size_t edge = 0; edge < 3; ++edge)
      cut(left, rest[edge], near_m_, [&](const Vec3d& p) { return over.inside(edge, p); });
    if (!over.is_within(left, reach_m_ - near_m_)) return contains_halves(polygon, middle, depth);
    return contains(rest[0], depth + 1) && contains(rest[1], depth + 1) && contains(rest[2], depth + 1);
  }

  // Cut across its length.
  [[nodiscard]] bool contains_halves(const Polygon& polygon, const Vec3d& middle, int depth) {
    Vec3d farthest = polygon[0] - middle;
    for (int i = 1; i < polygon.count; ++i)
      if ((polygon[i] - middle).squaredNorm() > farthest.squaredNorm()) farthest = polygon[i] - middle;
    const double length = farthest.norm();
    if (!(length > near_m_)) return false;
    const Vec3d across = farthest / length;
    Polygon half = polygon, other;
    cut(half, other, near_m_, [&](const Vec3d& p) { return across.dot(p - middle); });
    return contains(half, depth + 1) && contains(other, depth + 1);
  }

  static std::vector<Prism> prisms(std::span<const Index> triangles, std::span<const Vec3f> positions) {
    std::vector<Prism> made;
    made.reserve(triangles.size() / 3);
    for (std::size_t t = 0; t < triangles.size() / 3; ++t)
      made.emplace_back(corners_of(triangles, t, positions));
    return made;
  }

  // A surface through a cube of n³ cells fills n² to 6 n² of them: a few triangles in each.
  Groups<Index> grid() {
    const double cells = std::clamp(std::sqrt(static_cast<double>(prisms_.size()) / 3), 8.0, 200.0);
    Vec3d low = prisms_[0].low, high = prisms_[0].high;
    for (const Prism& prism : prisms_) {
      low = low.cwiseMin(prism.low);
      high = high.cwiseMax(prism.high);
    }
    cell_m_ = std::max({reach_m_, (high - low).maxCoeff() / cells, std::numeric_limits<double>::min()});
    low_ = low.array() - reach_m_;
    size_ = {1, 1, 1};
    const Cell last = cell(high.array() + reach_m_);
    for (std::size_t i = 0; i < 3; ++i) size_[i] = last[i] + 1;
    return Groups<Index>(static_cast<std::size_t>(size_[0] * size_[1] * size_[2]), [&](const auto& put) {
      for (std::size_t t = 0; t < prisms_.size(); ++t) {
        const Cell from = cell(prisms_[t].low.array() - reach_m_);
        const Cell to = cell(prisms_[t].high.array() + reach_m_);
        for (auto x = from[0]; x <= to[0]; ++x)
          for (auto y = from[1]; y <= to[1]; ++y)
            for (auto z = from[2]; z <= to[2]; ++z)
              if (passes(prisms_[t], {x, y, z})) put(key({x, y, z}), static_cast<Index>(t));
      }
    });
  }

  // The triangle's plane comes within reach of the cell.
  [[nodiscard]] bool passes(const Prism& prism, const Cell& c) const {
    if (!prism.has_area()) return true;
    const Vec3d centre = low_ + cell_m_ * (Vec3d(static_cast<double>(c[0]), static_cast<double>(c[1]),
                                                 static_cast<double>(c[2])) +
                                           Vec3d::Constant(0.5));
    return std::abs(prism.height(centre)) <= reach_m_ + 0.5001 * cell_m_ * prism.normal.cwiseAbs().sum();
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

  double reach_m_;
  double near_m_;  // what counts as on a plane
  std::vector<Prism> prisms_;
  double cell_m_ = 1;
  Vec3d low_;
  Cell size_{};
  Groups<Index> cells_;
  Index last_ = 0;  // triangle that the last answer rested on: what was near it is often near the next
  int pieces_left_ = 0;
};

}  // namespace

bool lies_within(std::span<const Index> triangles, std::span<const Index> of,
                 std::span<const Vec3f> positions, double distance_m) {
  if (triangles.empty() || of.empty()) return triangles.empty();
  Neighbourhood near(of, positions, distance_m);
  for (std::size_t t = 0; t < triangles.size() / 3; ++t)
    if (!near.contains(corners_of(triangles, t, positions))) return false;
  return true;
}

bool stay_together(std::span<const Index> a, std::span<const Index> b, std::span<const Vec3f> positions,
                   double distance_m) {
  return lies_within(a, b, positions, distance_m) && lies_within(b, a, positions, distance_m);
}

}  // namespace lightwell::render
