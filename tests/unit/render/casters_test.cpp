// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/casters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "render/caster_mesh.h"
#include "render/light_rows.h"
#include "render/surface_distance.h"
#include "tests/support/test_scene.h"

namespace lightwell::render {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

TEST(Casters, ClosedMeshesAreToldFromOpenOnes) {
  Scene scene;
  add_sphere(scene, {0, 1, 0}, 0.5f, lambertian(Rgb::Ones()), true, 10);
  add_box(scene, {0, 0, 0}, {1, 1, 1}, lambertian(Rgb::Ones()));
  const Casters closed = find_casters(scene);
  EXPECT_EQ(closed.closed_count, scene.indices.size());
  scene.primitives[1].index_count -= 3;  // a hole in the box
  const Casters holed = find_casters(scene);
  EXPECT_EQ(holed.open_count, 33u);
}

TEST(Casters, WeldingLeavesOneVertexAPosition) {
  Scene scene;
  add_box(scene, {0, 0, 0}, {1, 1, 1}, lambertian(Rgb::Ones()));
  EXPECT_EQ(find_casters(scene).positions.size(), 8u);
}

TEST(Casters, NothingThatCastsIsEmpty) {
  Scene scene;
  add_ground(scene, lambertian(Rgb::Ones()), false);
  const Casters casters = find_casters(scene);
  EXPECT_TRUE(casters.indices.empty());
  EXPECT_EQ(casters.objects.radius, 0);
}

TEST(Casters, ASupportHasEverythingOnItsFront) {
  Scene scene;
  add_ground(scene, lambertian(Rgb::Ones()), true);
  add_box(scene, {0, 0, 0}, {1, 1, 1}, lambertian(Rgb::Ones()));
  EXPECT_TRUE(find_casters(scene).is_support[0]);
  add_box(scene, {0, -2, 0}, {1, -1, 1}, lambertian(Rgb::Ones()));  // below the ground
  EXPECT_FALSE(find_casters(scene).is_support[0]);
}

TEST(BoundingSphere, ContainsEveryPointAndIsNearTheSmallest) {
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  std::vector<Vec3f> points;
  for (int i = 0; i < 500; ++i)
    points.emplace_back(Vec3f(3, -2, 1) +
                        2 * Vec3f(normal(random), normal(random), normal(random)).normalized());
  const Sphere sphere = bounding_sphere(points);
  for (const Vec3f& p : points) EXPECT_LE((p - sphere.centre).norm(), sphere.radius);
  EXPECT_LT(sphere.radius, 2 * 1.01f);
  EXPECT_GT(bounding_sphere(std::vector<Vec3f>{{1, 2, 3}}).radius, 0);
  EXPECT_EQ(bounding_sphere({}).radius, 0);
}

TEST(LightRows, MapEveryCasterIntoTheUnitCubeAndDepthAwayFromTheLight) {
  Scene scene;
  add_box(scene, {-1, 0, 2}, {1, 3, 2.5f}, lambertian(Rgb::Ones()));
  const Casters casters = find_casters(scene);
  for (const Vec3f& d : {Vec3f(0, 1, 0), Vec3f(0, -1, 0), Vec3f(1, 0.2f, -3)}) {
    const LightSet lights = light_set({{d, Rgb::Ones()}});
    auto lit = make_light_rows(lights.lights, casters);
    ASSERT_EQ(lit.size(), 1u);
    fit_map(lit[0], casters, 64);
    const MapRows rows = map_rows(lit[0], casters);
    float widest = 0;  // the map is filled, but for its border
    for (const Vec3f& p : casters.positions)
      widest = std::max(widest, rows.u[0] * p.x() + rows.u[1] * p.y() + rows.u[2] * p.z() + rows.u[3]);
    EXPECT_GT(widest, 61.0f / 64);
    const auto place = [&](const float(&row)[4], const Vec3f& p) {
      return row[0] * p.x() + row[1] * p.y() + row[2] * p.z() + row[3];
    };
    for (const Vec3f& p : casters.positions) {
      for (const float s : {place(rows.u, p), place(rows.v, p)}) {
        EXPECT_GE(s, 1.0f / 64);
        EXPECT_LE(s, 63.0f / 64);
      }
      EXPECT_GE(place(rows.w, p), 0);
      EXPECT_LT(place(rows.w, p), 1);
      EXPECT_GT(place(rows.w, p), place(rows.w, p + d.normalized()));
    }
  }
}

TEST(LightRows, LightsWithoutPowerTakeNoMap) {
  const LightSet lights = light_set({{Vec3f::UnitY(), Rgb::Zero()}, {Vec3f::UnitX(), Rgb(0, 0, 1)}});
  EXPECT_EQ(make_light_rows(lights.lights, Casters{}).size(), 1u);
}

float distance_to_triangle(const Vec3f& p, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const Vec3f n = (b - a).cross(c - a);
  const auto is_left_of = [&](const Vec3f& from, const Vec3f& to) {
    return n.dot((to - from).cross(p - from)) >= 0;
  };
  const auto to_edge = [&](const Vec3f& from, const Vec3f& to) {
    const float t = (p - from).dot(to - from) / (to - from).squaredNorm();
    return (from + std::clamp(t, 0.0f, 1.0f) * (to - from) - p).norm();
  };
  if (is_left_of(a, b) && is_left_of(b, c) && is_left_of(c, a)) return std::abs(n.normalized().dot(p - a));
  return std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
}

// Of the first run: the closed meshes.
double volume(const Casters& casters) {
  double sum = 0;
  for (std::size_t t = 0; t < casters.closed_count; t += 3) {
    const auto corner = [&](std::size_t i) -> Vec3d {
      return casters.positions[casters.indices[t + i]].cast<double>();
    };
    sum += corner(0).dot(corner(1).cross(corner(2))) / 6;
  }
  return sum;
}

TEST(SimplifiedCasters, HaveFewerTrianglesTheCoarserTheMapsAndTheSameBounds) {
  Scene scene;
  add_sphere(scene, {0, 1, 0}, 0.5f, lambertian(Rgb::Ones()));
  const Casters full = find_casters(scene);
  std::size_t last = full.indices.size() + 1;
  for (const int size : {4096, 1024, 256, 64, 16}) {
    const Casters fewer = find_casters(scene, size);
    EXPECT_LE(fewer.indices.size(), last) << size;
    EXPECT_EQ(fewer.objects.radius, full.objects.radius);
    EXPECT_EQ(fewer.objects.centre, full.objects.centre);
    last = fewer.indices.size();
  }
  // Facets that lie e inside a sphere of radius r reach over √(8e/r) r: at e = r/512, r/8, so about 4π 8² · 2 =
  // 1600 of the 14,160 are needed; at e = r/32, 100. The library, which keeps given corners and knows no
  // maximum, needs several times as many.
  EXPECT_LT(find_casters(scene, 256).indices.size(), full.indices.size() * 3 / 4);
  EXPECT_LT(last / 3, 100u * 5);
}

TEST(SimplifiedCasters, ClosedMeshesStayClosed) {
  Scene scene;
  add_sphere(scene, {0, 3, 0}, 0.5f, lambertian(Rgb::Ones()));
  add_box(scene, {-1, 0, -1}, {1, 1, 1}, lambertian(Rgb::Ones()));
  add_lattice(scene, 0.01f);
  for (const int size : {16, 64, 256, 1024}) {
    const Casters casters = find_casters(scene, size);
    EXPECT_EQ(casters.closed_count, casters.indices.size()) << size;
    EXPECT_TRUE(is_closed(casters.indices)) << size;
  }
}

// The largest distance from corners of `from` and points spread over its triangles to the nearest triangle of
// `to`, one by one.
float farthest(const Casters& from, const Casters& to) {
  constexpr int kSteps = 4;
  float worst = 0;
  for (std::size_t t = 0; t < from.indices.size(); t += 3)
    for (int i = 0; i <= kSteps; ++i)
      for (int k = 0; i + k <= kSteps; ++k) {
        const float u = static_cast<float>(i) / kSteps;
        const float v = static_cast<float>(k) / kSteps;
        const Vec3f p = (1 - u - v) * from.positions[from.indices[t]] +
                        u * from.positions[from.indices[t + 1]] + v * from.positions[from.indices[t + 2]];
        float nearest = std::numeric_limits<float>::max();
        for (std::size_t n = 0; n < to.indices.size(); n += 3)
          nearest = std::min(
              nearest, distance_to_triangle(p, to.positions[to.indices[n]], to.positions[to.indices[n + 1]],
                                            to.positions[to.indices[n + 2]]));
        worst = std::max(worst, nearest);
      }
  return worst;
}

TEST(SimplifiedCasters, NoPointOfEitherSurfaceIsFartherFromTheOtherThanTheirShareOfATexel) {
  Scene scene;
  add_sphere(scene, {0, 1, 0}, 0.5f, lambertian(Rgb::Ones()), true, 16);
  add_box(scene, {-1, 0, -1}, {1, 0.4f, 1}, lambertian(Rgb::Ones()));
  add_lattice(scene, 0.02f);
  const Casters full = find_casters(scene);
  for (const int size : {16, 64}) {
    const Casters fewer = find_casters(scene, size);
    ASSERT_LT(fewer.indices.size(), full.indices.size());
    // A texel is the map's share of the sphere's diameter; single precision's share on top.
    const float bound =
        render::kSimplifiedTexels * 2 * full.objects.radius / static_cast<float>(size) * (1 + 1e-5f);
    EXPECT_LE(farthest(full, fewer), bound) << size;
    EXPECT_LE(farthest(fewer, full), bound) << size;
  }
}

// A closed ball of waves, of 4 r (r − 1) triangles by rings of 2 r sectors: large enough to be simplified by patches.
struct Ball {
  std::vector<Vec3f> positions;
  std::vector<std::uint32_t> triangles;
};
Ball wavy_ball(std::uint32_t rings) {
  Ball ball;
  const std::uint32_t sectors = 2 * rings;
  const auto add = [&](double polar, double around) {
    const double radius = 1 + 0.03 * std::sin(9 * polar) * std::cos(7 * around) * std::sin(polar);
    ball.positions.push_back((radius * Vec3d(std::sin(polar) * std::cos(around), std::cos(polar),
                                             std::sin(polar) * std::sin(around)))
                                 .cast<float>());
  };
  add(0, 0);
  for (std::uint32_t r = 1; r < rings; ++r)
    for (std::uint32_t s = 0; s < sectors; ++s) add(kPi * r / rings, 2 * kPi * s / sectors);
  add(kPi, 0);
  const auto at = [&](std::uint32_t r, std::uint32_t s) {
    if (r == 0) return 0u;
    if (r == rings) return static_cast<std::uint32_t>(ball.positions.size() - 1);
    return 1 + (r - 1) * sectors + s % sectors;
  };
  for (std::uint32_t r = 0; r < rings; ++r)
    for (std::uint32_t s = 0; s < sectors; ++s) {
      if (r > 0) ball.triangles.insert(ball.triangles.end(), {at(r, s), at(r, s + 1), at(r + 1, s)});
      if (r + 1 < rings)
        ball.triangles.insert(ball.triangles.end(), {at(r, s + 1), at(r + 1, s + 1), at(r + 1, s)});
    }
  return ball;
}

// How often each edge is run along, one way less the other.
bool every_edge_is_run_both_ways(const std::vector<std::uint32_t>& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::uint32_t a = triangles[i];
    const std::uint32_t b = triangles[i % 3 == 2 ? i - 2 : i + 1];
    balance[std::minmax(a, b)] += a < b ? 1 : -1;
  }
  return std::all_of(balance.begin(), balance.end(), [](const auto& edge) { return edge.second == 0; });
}

// The distance of a random point of `from` to the nearest triangle of `to`, one by one; the worst of some.
float worst_of_some(const Ball& ball, std::span<const std::uint32_t> from,
                    std::span<const std::uint32_t> to) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> part(0, 1);
  float worst = 0;
  for (int i = 0; i < 600; ++i) {
    const std::size_t t = 3 * (random() % (from.size() / 3));
    float u = part(random), v = part(random);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Vec3f p = (1 - u - v) * ball.positions[from[t]] + u * ball.positions[from[t + 1]] +
                    v * ball.positions[from[t + 2]];
    float nearest = std::numeric_limits<float>::max();
    for (std::size_t n = 0; n < to.size(); n += 3)
      nearest = std::min(nearest, distance_to_triangle(p, ball.positions[to[n]], ball.positions[to[n + 1]],
                                                       ball.positions[to[n + 2]]));
    worst = std::max(worst, nearest);
  }
  return worst;
}

TEST(SimplifiedCasters, LargeMeshesKeepTheirDistanceAndStayClosedFromLevelToLevel) {
  const Ball ball = wavy_ball(130);
  ASSERT_GT(ball.triangles.size(), 3u * 60'000);
  ASSERT_TRUE(is_closed(ball.triangles));
  const auto fine = simplify(ball.triangles, ball.positions, 0.002f);
  const auto coarse = simplify(fine, ball.positions, 0.008f, 0.002f);
  // Waves of amplitude 0.03 and 9 and 7 to the round bend by up to 2.5: facets that lie 0.002 off reach over 0.08, and
  // 4π / (0.08²/2) are 4000; patches, whose borders stay at first, leave six times as many of the 67,000.
  EXPECT_LT(fine.size(), ball.triangles.size() / 2);
  EXPECT_LT(coarse.size(), fine.size() / 2);
  for (const auto& [fewer, bound] : {std::pair(&fine, 0.002f), std::pair(&coarse, 0.008f)}) {
    EXPECT_TRUE(every_edge_is_run_both_ways(*fewer));
    const float most = bound * (1 + 1e-4f);  // single precision of the measure
    EXPECT_LE(worst_of_some(ball, ball.triangles, *fewer), most);
    EXPECT_LE(worst_of_some(ball, *fewer, ball.triangles), most);
  }
}

TEST(SimplifiedCasters, OfSeveralLevelsTheLargestMapsAreThoseOfOne) {
  Scene scene;
  add_sphere(scene, {0, 1, 0}, 0.5f, lambertian(Rgb::Ones()));
  const auto levels = find_casters(scene, std::array{1024, 256});
  ASSERT_EQ(levels.size(), 2u);
  EXPECT_EQ(levels[0].indices, find_casters(scene, 1024).indices);
  EXPECT_EQ(levels[1].indices, find_casters(scene, 256).indices);
}

TEST(SurfacesStayTogether, WithinTheirDistanceAndNotBelowIt) {
  // Two unit squares one above the other, cut along different diagonals.
  const std::vector<Vec3f> corners = {{0, 0, 0},    {1, 0, 0},    {1, 0, 1},    {0, 0, 1},
                                      {0, 0.1f, 0}, {1, 0.1f, 0}, {1, 0.1f, 1}, {0, 0.1f, 1}};
  const std::vector<std::uint32_t> low = {0, 1, 2, 0, 2, 3};
  const std::vector<std::uint32_t> high = {4, 5, 7, 5, 6, 7};
  EXPECT_TRUE(stay_together(low, low, corners, 1e-6));
  EXPECT_TRUE(stay_together(low, high, corners, 0.101));
  EXPECT_FALSE(stay_together(low, high, corners, 0.099));
  EXPECT_FALSE(stay_together(low, std::span(high).first(3), corners, 0.101));  // half of it is missing
  EXPECT_FALSE(stay_together(std::span(low).first(3), high, corners, 0.101));
  EXPECT_FALSE(stay_together({}, high, corners, 1e9));
  EXPECT_TRUE(stay_together({}, {}, corners, 0));
}

TEST(SurfacesStayTogether, ASpikeBetweenTheCornersOfALargeTriangleIsSeen) {
  // A flat triangle, and the same with its middle pulled up by 0.2.
  const std::vector<Vec3f> corners = {{0, 0, 0}, {3, 0, 0}, {0, 0, 3}, {1, 0.2f, 1}};
  const std::vector<std::uint32_t> flat = {0, 2, 1};
  const std::vector<std::uint32_t> spike = {0, 3, 1, 1, 3, 2, 2, 3, 0};
  EXPECT_FALSE(stay_together(flat, spike, corners, 0.15));
  EXPECT_TRUE(stay_together(flat, spike, corners, 0.201));
}

TEST(SimplifiedCasters, ALatticeOfBarsThinnerThanATexelSurvives) {
  for (const float radius : {0.02f, 0.005f, 0.001f}) {
    Scene scene;
    const std::size_t bars = add_lattice(scene, radius);
    const Casters full = find_casters(scene);
    for (const int size : {16, 256}) {
      const Casters fewer = find_casters(scene, size);
      EXPECT_TRUE(is_closed(fewer.indices));
      // The least a closed piece has is a tetrahedron; a bar with ends and sides has more.
      EXPECT_GE(fewer.indices.size() / 3, bars * 8);
      // A surface moved by V/4A takes a quarter of the volume.
      EXPECT_GE(volume(fewer), 0.75 * volume(full));
      Vec3f low = full.positions[0], high = low, low_of_fewer = low, high_of_fewer = low;
      for (const Vec3f& p : full.positions) low = low.cwiseMin(p), high = high.cwiseMax(p);
      low_of_fewer = high, high_of_fewer = low;
      for (const Vec3f& p : fewer.positions)
        low_of_fewer = low_of_fewer.cwiseMin(p), high_of_fewer = high_of_fewer.cwiseMax(p);
      EXPECT_LE((low_of_fewer - low).maxCoeff(), radius);
      EXPECT_LE((high - high_of_fewer).maxCoeff(), radius);
    }
  }
}

TEST(SimplifiedCasters, FreeBordersStay) {
  // A flat sheet of 20×20 squares: its inside needs no corner, its border keeps all 80.
  constexpr std::uint32_t kSide = 20;
  std::vector<Vec3f> positions;
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t y = 0; y <= kSide; ++y)
    for (std::uint32_t x = 0; x <= kSide; ++x)
      positions.emplace_back(static_cast<float>(x), 0.0f, static_cast<float>(y));
  for (std::uint32_t y = 0; y < kSide; ++y)
    for (std::uint32_t x = 0; x < kSide; ++x) {
      const std::uint32_t a = y * (kSide + 1) + x;
      const std::uint32_t b = a + kSide + 1;
      triangles.insert(triangles.end(), {a, b, b + 1, a, b + 1, a + 1});
    }
  const auto fewer = simplify(triangles, positions, 0.1f);
  EXPECT_LT(fewer.size(), triangles.size() / 3);
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    const std::uint32_t x = i % (kSide + 1);
    const std::uint32_t y = i / (kSide + 1);
    if (x % kSide == 0 || y % kSide == 0) {
      EXPECT_NE(std::find(fewer.begin(), fewer.end(), i), fewer.end()) << i;
    }
  }
  double area = 0;
  for (std::size_t t = 0; t < fewer.size(); t += 3)
    area += 0.5 * static_cast<double>((positions[fewer[t + 1]] - positions[fewer[t]])
                                          .cross(positions[fewer[t + 2]] - positions[fewer[t]])
                                          .y());
  EXPECT_NEAR(area, kSide * kSide, 1e-3);  // small whole numbers: single precision is exact
}

// Of many triangles, whose patches a curve through their box finds: a box without extent, and one of the least.
TEST(SimplifiedCasters, ManyTrianglesInOnePointStayInIt) {
  for (const float extent : {0.0f, std::numeric_limits<float>::denorm_min(), 1e-38f}) {
    std::vector<Vec3f> positions = {Vec3f(1, 2, 3) * extent};
    std::vector<std::uint32_t> fan;
    for (std::uint32_t i = 1; i <= 20'002; ++i) {
      const float angle = static_cast<float>(i) * 3e-4f;
      positions.emplace_back(extent * std::cos(angle), extent * std::sin(angle), 0);
      if (i > 1) fan.insert(fan.end(), {0, i - 1, i});
    }
    const auto fewer = simplify(fan, positions, 0.1f);
    EXPECT_EQ(fewer.size() % 3, 0u);
    EXPECT_LE(fewer.size(), fan.size());
    for (const std::uint32_t i : fewer) ASSERT_LT(i, positions.size());
  }
}

TEST(SimplifiedCasters, WhatCannotBeSimplerStays) {
  const std::vector<Vec3f> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<std::uint32_t> tetrahedron = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  EXPECT_EQ(simplify(tetrahedron, corners, 10).size(), tetrahedron.size());
  EXPECT_EQ(simplify(std::span(tetrahedron).first(3), corners, 10).size(), 3u);
  EXPECT_TRUE(simplify({}, corners, 10).empty());
  // Both sides of one triangle: closed, of no volume.
  const std::vector<std::uint32_t> leaf = {0, 1, 2, 0, 2, 1};
  EXPECT_EQ(simplify(leaf, corners, 10).size(), leaf.size());
}

}  // namespace
}  // namespace lightwell::render
