// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/sampling/relaxation.h"

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

// Signed difference of two places on a circle of length 1, in [−½, ½].
double torus_difference(double to, double from) {
  const double d = to - from;
  return d > 0.5 ? d - 1 : d < -0.5 ? d + 1 : d;
}

double torus_distance2(const Vec2d& a, const Vec2d& b) {
  const double dx = torus_difference(a.x(), b.x());
  const double dy = torus_difference(a.y(), b.y());
  return dx * dx + dy * dy;
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

  // Nearest point on the torus; of equally near ones the one with the lowest index. guess: any point, better
  // a near one: only the cells that a circle through it touches are searched.
  [[nodiscard]] std::size_t nearest(std::span<const Vec2d> points, const Vec2d& site,
                                    std::size_t guess) const {
    std::size_t best = guess;
    double best_d2 = torus_distance2(points[guess], site);
    const double radius = std::sqrt(best_d2);
    const Span rows = cells_within(site.y(), radius);
    const Span columns = cells_within(site.x(), radius);
    for (std::ptrdiff_t row = rows.first; row <= rows.last; ++row)
      for (std::ptrdiff_t column = columns.first; column <= columns.last; ++column)
        visit(points, site, wrap(row) * side_ + wrap(column), best, best_d2);
    return best;
  }

 private:
  [[nodiscard]] std::size_t index(double x) const {
    return std::min(side_ - 1, static_cast<std::size_t>(x * static_cast<double>(side_)));
  }
  [[nodiscard]] std::size_t cell(const Vec2d& p) const { return index(p.y()) * side_ + index(p.x()); }
  // i: at most one turn below or above the torus
  [[nodiscard]] std::size_t wrap(std::ptrdiff_t i) const {
    const auto side = static_cast<std::ptrdiff_t>(side_);
    return static_cast<std::size_t>(i < 0 ? i + side : i >= side ? i - side : i);
  }
  struct Span {
    std::ptrdiff_t first, last;
  };
  // Cells along one axis that [x − radius, x + radius] touches, unwrapped, each at most once.
  [[nodiscard]] Span cells_within(double x, double radius) const {
    const auto side = static_cast<double>(side_);
    const auto first = static_cast<std::ptrdiff_t>(std::floor((x - radius) * side));
    const auto last = static_cast<std::ptrdiff_t>(std::floor((x + radius) * side));
    return {first, std::min(last, first + static_cast<std::ptrdiff_t>(side_) - 1)};
  }
  void visit(std::span<const Vec2d> points, const Vec2d& site, std::size_t cell, std::size_t& best,
             double& best_d2) const {
    for (std::size_t m = first_[cell]; m < first_[cell + 1]; ++m) {
      const std::size_t i = member_[m];
      const double d2 = torus_distance2(points[i], site);
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
  std::size_t i = 0;  // the last site's nearest point is a good guess for this one's
  for (std::size_t row = 0; row < sites_per_side; ++row) {
    for (std::size_t column = 0; column < sites_per_side; ++column) {
      const Vec2d site((static_cast<double>(column) + 0.5) * step, (static_cast<double>(row) + 0.5) * step);
      i = buckets.nearest(points, site, i);
      offset_sum[i] +=
          Vec2d(torus_difference(site.x(), points[i].x()), torus_difference(site.y(), points[i].y()));
      sites[i] += 1;
    }
  }
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (sites[p] == 0) continue;  // a cell finer than the grid: the point is crowded out for this pass
    const Vec2d moved = points[p] + offset_sum[p] / sites[p];
    points[p] = {wrapped(moved.x()), wrapped(moved.y())};
  }
}

}  // namespace

void relax_on_torus(std::span<Vec2d> points, int passes) {
  if (points.size() < 2) return;  // one cell, the whole torus: its centroid is anywhere
  const std::size_t sites =
      std::max({16 * points.size(), std::min<std::size_t>(64 * points.size(), 65536), std::size_t{4096}});
  const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(sites))));
  for (int pass = 0; pass < passes; ++pass) relax_once(points, side);
}

}  // namespace lightwell
