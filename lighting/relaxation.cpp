// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/relaxation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lightwell {
namespace {

double wrapped(double x) {
  x -= std::floor(x);
  return x < 1 ? x : 0;  // a tiny negative number rounds up to 1
}

// Signed difference on a circle of length 1, in [−½, ½].
double torus_difference(double to, double from) {
  const double d = to - from;
  return d - std::round(d);
}

// The points sorted into side² square cells of the torus, about two points a cell.
class Buckets {
 public:
  explicit Buckets(std::span<const Vec2d> points)
      : side_(std::max<std::size_t>(
            1, static_cast<std::size_t>(std::sqrt(static_cast<double>(points.size()) / 2)))),
        first_(side_ * side_ + 1, 0),
        member_(points.size()) {
    for (const Vec2d& p : points) ++first_[cell(p) + 1];
    for (std::size_t c = 0; c < side_ * side_; ++c) first_[c + 1] += first_[c];
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < points.size(); ++i)
      member_[next[cell(points[i])]++] = static_cast<std::uint32_t>(i);
  }

  // Nearest point on the torus; of equally near ones the one with the lowest index.
  [[nodiscard]] std::size_t nearest(std::span<const Vec2d> points, const Vec2d& site) const {
    std::size_t best = 0;
    double best_d2 = 2;
    const auto row = static_cast<std::ptrdiff_t>(index(site.y()));
    const auto column = static_cast<std::ptrdiff_t>(index(site.x()));
    const auto side = static_cast<std::ptrdiff_t>(side_);
    for (std::ptrdiff_t ring = 0; ring <= side / 2 + 1; ++ring) {
      // Nothing in this ring of cells can be nearer than ring − 1 whole cells.
      const double reach = static_cast<double>(ring - 1) / static_cast<double>(side_);
      if (ring > 1 && best_d2 < reach * reach) break;
      for (std::ptrdiff_t dy = -ring; dy <= ring; ++dy)
        for (std::ptrdiff_t dx = -ring; dx <= ring;
             dx += std::abs(dy) == ring ? 1 : std::max<std::ptrdiff_t>(1, 2 * ring))
          visit(points, site, wrap(row + dy), wrap(column + dx), best, best_d2);
    }
    return best;
  }

 private:
  [[nodiscard]] std::size_t index(double x) const {
    return std::min(side_ - 1, static_cast<std::size_t>(x * static_cast<double>(side_)));
  }
  [[nodiscard]] std::size_t cell(const Vec2d& p) const { return index(p.y()) * side_ + index(p.x()); }
  [[nodiscard]] std::size_t wrap(std::ptrdiff_t i) const {
    const auto side = static_cast<std::ptrdiff_t>(side_);
    return static_cast<std::size_t>(((i % side) + side) % side);
  }
  void visit(std::span<const Vec2d> points, const Vec2d& site, std::size_t row, std::size_t column,
             std::size_t& best, double& best_d2) const {
    const std::size_t c = row * side_ + column;
    for (std::size_t m = first_[c]; m < first_[c + 1]; ++m) {
      const std::size_t i = member_[m];
      const double dx = torus_difference(points[i].x(), site.x());
      const double dy = torus_difference(points[i].y(), site.y());
      const double d2 = dx * dx + dy * dy;
      if (d2 < best_d2 || (d2 == best_d2 && i < best)) {
        best_d2 = d2;
        best = i;
      }
    }
  }

  std::size_t side_;
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> member_;
};

void relax_once(std::span<Vec2d> points, std::size_t sites_per_side) {
  const Buckets buckets(points);
  std::vector<Vec2d> offset_sum(points.size(), Vec2d(0, 0));
  std::vector<double> sites(points.size(), 0);
  const double step = 1.0 / static_cast<double>(sites_per_side);
  for (std::size_t row = 0; row < sites_per_side; ++row) {
    for (std::size_t column = 0; column < sites_per_side; ++column) {
      const Vec2d site((static_cast<double>(column) + 0.5) * step, (static_cast<double>(row) + 0.5) * step);
      const std::size_t i = buckets.nearest(points, site);
      offset_sum[i] +=
          Vec2d(torus_difference(site.x(), points[i].x()), torus_difference(site.y(), points[i].y()));
      sites[i] += 1;
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (sites[i] == 0) continue;  // a cell finer than the grid: the point is crowded out for this pass
    const Vec2d moved = points[i] + offset_sum[i] / sites[i];
    points[i] = {wrapped(moved.x()), wrapped(moved.y())};
  }
}

}  // namespace

void relax_on_torus(std::span<Vec2d> points, int passes) {
  if (points.size() < 2) return;  // one cell, the whole torus: its centroid is anywhere
  constexpr double kSitesPerPoint = 16;
  constexpr std::size_t kLeastSitesPerSide = 256;
  const auto side =
      static_cast<std::size_t>(std::ceil(std::sqrt(kSitesPerPoint * static_cast<double>(points.size()))));
  for (int pass = 0; pass < passes; ++pass) relax_once(points, std::max(side, kLeastSitesPerSide));
}

}  // namespace lightwell
