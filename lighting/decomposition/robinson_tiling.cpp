// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/robinson_tiling.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "lighting/result.h"

namespace lightwell {
namespace {

constexpr double kGolden = std::numbers::phi;

constexpr std::array<std::int64_t, 91> kFibonacci = [] {
  std::array<std::int64_t, 91> f = {0, 1};
  for (std::size_t n = 2; n < f.size(); ++n) f[n] = f[n - 1] + f[n - 2];
  return f;
}();

Vec2d golden_section(const Vec2d& from, const Vec2d& to) {
  return from + (to - from) / kGolden;
}

// Two digits in front of a code of m.
std::int64_t with_01(const RobinsonTriangle& t) {
  return t.code + fibonacci(t.digits + 2);
}
std::int64_t with_10(const RobinsonTriangle& t) {
  return t.code + fibonacci(t.digits + 3);
}

Subdivision subdivide_thin(const RobinsonTriangle& t) {
  using enum RobinsonTriangle::Rhombus;
  const Vec2d p = golden_section(t.apex, t.b);
  const int digits = t.digits + 2;
  Subdivision s;
  s.triangles = 2;
  s.triangle[0] = {thin, t.left, t.c, p, t.b, with_10(t), digits};
  s.triangle[1] = {thick, !t.left, p, t.c, t.apex, t.code, digits};
  s.vertices = t.left ? 1 : 0;
  s.vertex[0] = {p, with_10(t)};
  return s;
}

Subdivision subdivide_thick(const RobinsonTriangle& t) {
  using enum RobinsonTriangle::Rhombus;
  const Vec2d on_edge = golden_section(t.b, t.apex);
  const Vec2d on_diagonal = golden_section(t.b, t.c);
  const int digits = t.digits + 2;
  Subdivision s;
  s.triangles = 3;
  s.triangle[0] = {thick, t.left, on_diagonal, t.c, t.apex, t.code, digits};
  s.triangle[1] = {thick, !t.left, on_edge, on_diagonal, t.b, with_01(t), digits};
  s.triangle[2] = {thin, t.left, on_diagonal, on_edge, t.apex, with_10(t), digits};
  s.vertices = t.left ? 2 : 0;
  s.vertex[0] = {on_edge, with_10(t)};
  s.vertex[1] = {on_diagonal, with_01(t)};
  return s;
}

}  // namespace

std::int64_t fibonacci(int n) {
  verify_bug(n >= 1 && n <= 90, "a Fibonacci number beyond 63 bits");
  return kFibonacci[static_cast<std::size_t>(n)];
}

std::int64_t RobinsonTriangle::least_rank() const {
  return code + fibonacci(digits + (rhombus == Rhombus::thick ? 2 : 3));
}

Subdivision subdivide(const RobinsonTriangle& triangle) {
  verify_bug(triangle.digits <= kMostDigits, "a tile too deep in the hierarchy");
  return triangle.rhombus == RobinsonTriangle::Rhombus::thin ? subdivide_thin(triangle)
                                                             : subdivide_thick(triangle);
}

RobinsonTriangle triangle_around_unit_disc(double turn_rad) {
  // Far larger than the disc, which lies off its axis: tiles opposite each other across the axis of a large one
  // have codes in a row, so about the axis the first few vertices come out crowded.
  const double radius = kGolden * kGolden * kGolden;  // of the incircle
  const Vec2d centre = Vec2d(0.3, 0.2) * radius;      // of the disc, from the incircle's
  const double half_apex = kPi / 10;
  const double apex_height = radius / std::sin(half_apex);
  const double half_base = (apex_height + radius) * std::tan(half_apex);
  const Eigen::Rotation2Dd turn(turn_rad);
  RobinsonTriangle t;
  t.apex = turn * (Vec2d(0, apex_height) - centre);
  t.b = turn * (Vec2d(-half_base, -radius) - centre);
  t.c = turn * (Vec2d(half_base, -radius) - centre);
  return t;
}

}  // namespace lightwell
