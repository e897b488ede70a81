// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/penrose_sampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "lighting/decomposition/map_maximum.h"
#include "lighting/decomposition/robinson_tiling.h"
#include "lighting/sampling/random_points.h"
#include "lighting/spherical_cap.h"
#include "tests/support/decomposition_maps.h"

namespace lightwell {
namespace {

// All tiles and vertices to a depth.
struct Tiling {
  std::vector<RobinsonTriangle> tiles;
  std::vector<TilingVertex> vertices;

  Tiling(const RobinsonTriangle& root, int depth) : tiles{root} {
    for (int level = 0; level < depth; ++level) {
      std::vector<RobinsonTriangle> finer;
      for (const RobinsonTriangle& tile : tiles) {
        const Subdivision parts = subdivide(tile);
        for (const auto& child : parts.children()) finer.push_back(child);
        for (const auto& vertex : parts.new_vertices()) vertices.push_back(vertex);
      }
      tiles = std::move(finer);
    }
  }
};

double area(const RobinsonTriangle& t) {
  const Vec2d u = t.b - t.apex;
  const Vec2d v = t.c - t.apex;
  return std::abs(u.x() * v.y() - u.y() * v.x()) / 2;
}

TEST(RobinsonTiling, TilesKeepTheirShapeAndTheArea) {
  const RobinsonTriangle root = triangle_around_unit_disc(0.3);
  const Tiling tiling(root, 6);
  double sum = 0;
  for (const RobinsonTriangle& t : tiling.tiles) {
    sum += area(t);
    const double side = (t.b - t.apex).norm();
    EXPECT_NEAR((t.c - t.apex).norm() / side, 1, 1e-12);
    const double golden = (1 + std::sqrt(5.0)) / 2;
    const double base = t.rhombus == RobinsonTriangle::Rhombus::thin ? 1 / golden : golden;
    EXPECT_NEAR((t.c - t.b).norm() / side, base, 1e-12);
  }
  EXPECT_NEAR(sum / area(root), 1, 1e-12);
}

TEST(RobinsonTiling, DiscLiesInsideTheRoot) {
  for (const double turn : {0.0, 1.0, 4.0}) {
    const RobinsonTriangle root = triangle_around_unit_disc(turn);
    const Vec2d corners[] = {root.apex, root.b, root.c};
    for (int k = 0; k < 3; ++k) {
      const Vec2d edge = corners[(k + 1) % 3] - corners[k];
      // Distance of the disc's centre from the edge.
      EXPECT_GT(std::abs(edge.x() * corners[k].y() - edge.y() * corners[k].x()) / edge.norm(), 1);
    }
  }
}

TEST(RobinsonTiling, NoCodeComesTwiceAndNoneHasTwoOnesInARow) {
  const Tiling tiling(triangle_around_unit_disc(0), 8);
  std::set<std::int64_t> codes;
  for (const RobinsonTriangle& t : tiling.tiles) {
    EXPECT_TRUE(codes.insert(t.code).second);
    EXPECT_GE(t.code, 0);
    EXPECT_LT(t.code, fibonacci(t.digits + 2));
    // Greedy digits of a number are the ones without two ones in a row (Zeckendorf); the first tells the shape.
    EXPECT_EQ(t.code >= fibonacci(t.digits + 1), t.rhombus == RobinsonTriangle::Rhombus::thin);
  }
}

TEST(RobinsonTiling, EveryVertexIsCountedOnceAndRanksDiffer) {
  const Tiling tiling(triangle_around_unit_disc(0), 9);
  std::set<std::pair<long, long>> places;
  std::set<std::int64_t> ranks;
  for (const TilingVertex& v : tiling.vertices) {
    const auto key = std::pair{std::lround(v.place.x() * 1e7), std::lround(v.place.y() * 1e7)};
    EXPECT_TRUE(places.insert(key).second);
    EXPECT_TRUE(ranks.insert(v.rank).second);
  }
  // All vertices of the tiles but those on the root's border, whose left halves may lie outside.
  std::size_t inside = 0;
  std::set<std::pair<long, long>> corners;
  for (const RobinsonTriangle& t : tiling.tiles)
    for (const Vec2d& p : {t.apex, t.b, t.c})
      if (p.norm() < 1 && corners.insert({std::lround(p.x() * 1e7), std::lround(p.y() * 1e7)}).second) {
        ++inside;
        EXPECT_EQ(places.count({std::lround(p.x() * 1e7), std::lround(p.y() * 1e7)}), 1u);
      }
  EXPECT_GT(inside, 50u);
}

TEST(RobinsonTiling, LeastRankIsABoundForAllThatComesOfATile) {
  for (const RobinsonTriangle& tile : Tiling(triangle_around_unit_disc(0), 3).tiles)
    for (const TilingVertex& v : Tiling(tile, 5).vertices) EXPECT_GE(v.rank, tile.least_rank());
}

// Root mean square of (share of the points in a circle − its share of the area) over circles of the disc, times n.
double unevenness(const std::vector<Vec2d>& points) {
  double square = 0;
  int circles = 0;
  for (const Vec2d& u : random_points(300, 1)) {
    const double radius = 0.15 + 0.35 * u.x();
    const double distance = (1 - radius) * std::sqrt(u.y());
    const double angle = 2 * kPi * u.x() * 97;
    const Vec2d centre(distance * std::cos(angle), distance * std::sin(angle));
    double in = 0;
    for (const Vec2d& p : points) in += (p - centre).norm() < radius ? 1 : 0;
    const double off = in - radius * radius * static_cast<double>(points.size());
    square += off * off;
    ++circles;
  }
  return std::sqrt(square / circles);
}

TEST(RobinsonTiling, VerticesOfTheLowestRanksAreSpreadMoreEvenlyThanRandomPointsForAnyNumberOfThem) {
  std::vector<TilingVertex> vertices;
  for (const TilingVertex& v : Tiling(triangle_around_unit_disc(0), 12).vertices)
    if (v.place.norm() <= 1) vertices.push_back(v);
  std::sort(vertices.begin(), vertices.end(),
            [](const TilingVertex& a, const TilingVertex& b) { return a.rank < b.rank; });
  for (const std::size_t count : {16u, 40u, 100u, 250u, 500u}) {
    ASSERT_GT(vertices.size(), 2 * count);
    std::vector<Vec2d> points;
    for (std::size_t i = 0; i < count; ++i) points.push_back(vertices[i].place);
    std::vector<Vec2d> random;
    for (const Vec2d& u : random_points(count, 7))
      random.emplace_back(std::sqrt(u.x()) * std::cos(2 * kPi * u.y()),
                          std::sqrt(u.x()) * std::sin(2 * kPi * u.y()));
    EXPECT_LT(unevenness(points), 0.7 * unevenness(random)) << count;
  }
}

TEST(MapMaximum, BoundsEveryRectangleAndIsReachedNearby) {
  const PolarGrid grid{13, 37, kPi};
  std::vector<double> values;
  for (const Vec2d& u : random_points(grid.size(), 2)) values.push_back(std::pow(u.x(), 8));
  const MapMaximum maximum(grid, values);
  for (int ring0 = 0; ring0 < grid.rings; ++ring0)
    for (int ring1 = ring0; ring1 < grid.rings; ++ring1)
      for (int sector0 = 0; sector0 < grid.sectors; sector0 += 5)
        for (const int sectors : {1, 2, 3, 8, 17, 36, 37, 50}) {
          double most = 0;
          double nearby = 0;
          for (int r = 0; r < grid.rings; ++r)
            for (int k = -sectors; k < 2 * sectors; ++k) {
              const int s = ((sector0 + k) % grid.sectors + grid.sectors) % grid.sectors;
              const double value = values[static_cast<std::size_t>(r * grid.sectors + s)];
              if (r >= ring0 && r <= ring1 && k >= 0 && k < sectors) most = std::max(most, value);
              nearby = std::max(nearby, value);
            }
          const double bound = maximum.bound(ring0, ring1, sector0, sectors);
          EXPECT_GE(bound, most);
          EXPECT_LE(bound, nearby);
        }
}

// Independent and slow: the tiling divided everywhere, the scale found by bisection as the paper does.
std::vector<Vec3d> thresholded(const PolarMap& map, std::size_t count, int depth) {
  const double cap = cap_measure(map.grid.theta_max_rad);
  struct Candidate {
    Vec3d direction;
    double rank, density;
  };
  std::vector<Candidate> candidates;
  for (const TilingVertex& v : Tiling(triangle_around_unit_disc(0), depth).vertices) {
    if (v.place.norm() > 1) continue;
    const double y = 1 - v.place.squaredNorm() * cap;
    const double lambda = std::atan2(v.place.x(), v.place.y());
    const double h = std::sqrt(1 - y * y);
    const Vec3d d(h * std::sin(lambda), y, h * std::cos(lambda));
    const Spherical s = spherical_from_direction(d);
    const int ring =
        std::min(map.grid.rings - 1, static_cast<int>(s.theta_rad / map.grid.theta_max_rad * map.grid.rings));
    const int sector =
        std::min(map.grid.sectors - 1, static_cast<int>(s.lambda_rad / (2 * kPi) * map.grid.sectors));
    const auto bin = static_cast<std::size_t>(ring * map.grid.sectors + sector);
    candidates.push_back({d, static_cast<double>(v.rank), luminance(map.rgb(bin).cast<double>().eval())});
  }
  double low = 0;
  double high = 1e12;
  std::vector<Vec3d> chosen;
  for (int step = 0; step < 200 && chosen.size() != count; ++step) {
    const double scale = (low + high) / 2;
    chosen.clear();
    for (const Candidate& c : candidates)
      if (c.rank < scale * c.density) chosen.push_back(c.direction);
    (chosen.size() < count ? low : high) = scale;
  }
  return chosen;
}

TEST(PenroseSampling, BestFirstFindsTheVerticesThatTheThresholdDoes) {
  // Radiance within a factor of 30: all the vertices that 60 lights can call for lie within 14 levels.
  PolarMap map = PolarMap::make({30, 90, kPi / 2}, 3);
  for (int ring = 0; ring < 30; ++ring)
    for (int sector = 0; sector < 90; ++sector) {
      const Vec3d d = map.grid.bin_direction(ring, sector);
      test::set_bin(map, ring, sector,
                    Rgb::Constant(static_cast<float>(1 + 29 * std::pow(std::max(0.0, d.x()), 4))));
    }
  for (const std::size_t count : {1u, 7u, 60u}) {
    const auto expected = thresholded(map, count, 14);
    ASSERT_EQ(expected.size(), count);
    const auto lights = penrose_sampling(map, static_cast<int>(count), 0);
    for (const auto& light : lights) {
      double nearest = 9;
      for (const Vec3d& d : expected)
        nearest = std::min(nearest, (d - light.direction.cast<double>()).norm());
      EXPECT_LT(nearest, 1e-6) << count;  // float directions
    }
  }
}

TEST(PenroseSampling, FewerLightsAreTheFirstOfMore) {
  const PolarMap map = test::outdoor({45, 180, kPi / 2});
  const auto many = penrose_sampling(map, 100, 0);
  const auto few = penrose_sampling(map, 33, 0);
  for (std::size_t i = 0; i < few.size(); ++i) EXPECT_EQ(few[i].direction, many[i].direction);
}

TEST(PenroseSampling, LightsFollowThePowerOfTheMap) {
  const PolarMap map = test::sun_and_sky({45, 180, kPi / 2}, 50, 40, 0.6);
  const Vec3d sun = direction_from_spherical({40 * test::kDegree, 50 * test::kDegree});
  int in_sun = 0;
  for (const auto& light : penrose_sampling(map, 1000, 0))
    in_sun += light.direction.cast<double>().dot(sun) > std::cos(4 * test::kDegree) ? 1 : 0;
  // The sun's 600, and the sky's thousandth; an even set misses by less than √n, about 25.
  EXPECT_NEAR(in_sun, 601, 25);
}

TEST(PenroseSampling, SeedTurnsTheTiling) {
  const PolarMap map = test::outdoor({45, 180, kPi / 2});
  EXPECT_NE(penrose_sampling(map, 8, 0)[3].direction, penrose_sampling(map, 8, 12345678)[3].direction);
}

}  // namespace
}  // namespace lightwell
