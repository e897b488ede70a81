// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/luminaire/area_resampling.h"

#include <algorithm>
#include <cmath>

namespace lightwell {
namespace {

// A convex quad cut by two lines each way has at most eight corners; one that crosses itself, at most 19.
struct Polygon {
  std::array<Vec2d, 20> corners;
  std::size_t count = 0;
};

// What lies on one side of a line across an axis (Sutherland and Hodgman 1974); sign 1: what is above, −1: below.
Polygon cut(const Polygon& in, int axis, double at, double sign) {
  Polygon out;
  for (std::size_t i = 0; i < in.count; ++i) {
    const Vec2d &a = in.corners[i], &b = in.corners[(i + 1) % in.count];
    const double da = sign * (a[axis] - at), db = sign * (b[axis] - at);
    if (da >= 0) out.corners[out.count++] = a;
    if ((da > 0 && db < 0) || (da < 0 && db > 0)) {
      Vec2d crossing = a + (b - a) * (da / (da - db));
      crossing[axis] = at;
      out.corners[out.count++] = crossing;
    }
  }
  return out;
}

double area(const Polygon& p) {
  double twice = 0;
  for (std::size_t i = 0; i < p.count; ++i) {
    const Vec2d a = p.corners[i] - p.corners[0], b = p.corners[(i + 1) % p.count] - p.corners[0];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return std::abs(twice) / 2;
}

}  // namespace

AreaResampling::AreaResampling(const std::array<int, 2>& pixels, const Vec2d& low, const Vec2d& high)
    : pixels_(pixels), low_(low), pixel_((high - low).cwiseQuotient(Vec2d(pixels[0], pixels[1]))) {
  const auto count = static_cast<std::size_t>(pixels[0]) * static_cast<std::size_t>(pixels[1]);
  sums_.assign(count, Rgbd::Zero());
  areas_.assign(count, 0.0);
}

// take(column, row, area in pixels of the grid)
template <class F>
void AreaResampling::for_each_shared(const Quad& corners, const F& take) const {
  Polygon quad;
  Vec2d least = Vec2d::Constant(1e300), most = -least;
  for (const Vec2d& corner : corners) {
    if (!corner.allFinite()) return;
    quad.corners[quad.count] = (corner - low_).cwiseQuotient(pixel_);
    least = least.cwiseMin(quad.corners[quad.count]);
    most = most.cwiseMax(quad.corners[quad.count++]);
  }
  const Vec2d size(pixels_[0], pixels_[1]);
  if (!((most.array() > 0).all() && (least.array() < size.array()).all())) return;
  const auto from = [&](int axis) { return static_cast<int>(std::floor(std::max(least[axis], 0.0))); };
  const auto to = [&](int axis) { return static_cast<int>(std::ceil(std::min(most[axis], size[axis]))) - 1; };
  const int x0 = from(0), x1 = to(0), y0 = from(1), y1 = to(1);
  const bool inside = (least.array() >= 0).all() && (most.array() <= size.array()).all();
  if (inside && x0 >= x1 && y0 >= y1) {  // in one pixel, as most are under a fine camera
    take(std::min(x0, pixels_[0] - 1), std::min(y0, pixels_[1] - 1), area(quad));
    return;
  }
  for (int y = y0; y <= y1; ++y) {
    const Polygon row = cut(cut(quad, 1, y, 1), 1, y + 1, -1);
    for (int x = x0; x <= x1; ++x) {
      const double shared = area(cut(cut(row, 0, x, 1), 0, x + 1, -1));
      if (shared > 0) take(x, y, shared);
    }
  }
}

double AreaResampling::shared_area(const Quad& corners) const {
  double sum = 0;
  for_each_shared(corners, [&](int, int, double shared) { sum += shared; });
  return sum * pixel_.prod();
}

double AreaResampling::add(const Quad& corners, const Rgbd& value) {
  // Of a parallelogram about its middle: a twelfth of the squares of its sides.
  const Vec2d a = (corners[1] - corners[0] + corners[2] - corners[3]).cwiseQuotient(pixel_) / 2;
  const Vec2d b = (corners[3] - corners[0] + corners[2] - corners[1]).cwiseQuotient(pixel_) / 2;
  const Vec2d own = (a.cwiseProduct(a) + b.cwiseProduct(b)) / 12;
  const Vec2d middle =
      ((corners[0] + corners[1] + corners[2] + corners[3]) / 4 - low_).cwiseQuotient(pixel_).array() - 0.5;
  double all = 0;
  for_each_shared(corners, [&](int column, int row, double shared) {
    sums_[index(column, row)] += shared * value;
    areas_[index(column, row)] += shared;
    all += shared;
    const Vec2d off = middle - Vec2d(column, row);
    variances_ += shared * (own + off.cwiseProduct(off));
  });
  area_ += all;
  return all * pixel_.prod();
}

Rgbd AreaResampling::mean(int column, int row) const {
  const std::size_t i = index(column, row);
  return areas_[i] > 0 ? Rgbd(sums_[i] / areas_[i]) : Rgbd(Rgbd::Zero());
}

double AreaResampling::covered(int column, int row) const {
  return areas_[index(column, row)];
}

Vec2d AreaResampling::blur_variance() const {
  return area_ > 0 ? Vec2d(variances_ / area_) : Vec2d(Vec2d::Constant(1.0 / 12));
}

}  // namespace lightwell
