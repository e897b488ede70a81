// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lighting/sampling/concentric_map.h"
#include "lighting/sampling/halton.h"
#include "lighting/sampling/relaxation.h"

namespace lightwell {
namespace {

// Distance on the torus from each point to its nearest other one; the least and the mean over the points.
struct Spacing {
  double least = 2;
  double mean = 0;
};

Spacing spacing(const std::vector<Vec2d>& points) {
  Spacing result;
  for (std::size_t i = 0; i < points.size(); ++i) {
    double nearest = 2;
    for (std::size_t j = 0; j < points.size(); ++j) {
      if (i == j) continue;
      Vec2d d = points[i] - points[j];
      d -= d.array().round().matrix();
      nearest = std::min(nearest, d.norm());
    }
    result.least = std::min(result.least, nearest);
    result.mean += nearest / static_cast<double>(points.size());
  }
  return result;
}

TEST(Halton, FirstPointsAreThePublishedOnes) {
  const auto p = halton_points(5);
  const std::vector<Vec2d> expected = {
      {1.0 / 2, 1.0 / 3}, {1.0 / 4, 2.0 / 3}, {3.0 / 4, 1.0 / 9}, {1.0 / 8, 4.0 / 9}, {5.0 / 8, 7.0 / 9}};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_LT((p[i] - expected[i]).norm(), 1e-15) << i;  // rounding
}

TEST(Halton, PrefixDoesNotDependOnCount) {
  const auto few = halton_points(10, 3);
  const auto many = halton_points(1000, 3);
  for (std::size_t i = 0; i < few.size(); ++i) EXPECT_EQ(few[i], many[i]);
}

TEST(Halton, EveryElementaryIntervalHoldsOnePoint) {
  // 2^3 · 3^2 cells of 1/8 × 1/9 and any 72 consecutive points: one each (the definition of a low-discrepancy
  // sequence).
  const auto p = halton_points(72 * 3);
  for (std::size_t first : {std::size_t{0}, std::size_t{72}, std::size_t{100}}) {
    std::vector<int> hits(72, 0);
    for (std::size_t i = first; i < first + 72; ++i)  // the tiny step keeps 1/9 = .111… in its own cell
      ++hits[static_cast<std::size_t>(p[i].x() * 8 + 1e-9) * 9 +
             static_cast<std::size_t>(p[i].y() * 9 + 1e-9)];
    EXPECT_TRUE(std::all_of(hits.begin(), hits.end(), [](int n) { return n == 1; })) << first;
  }
}

TEST(Halton, SeedShiftsAllPointsAlikeOnTheTorus) {
  const auto plain = halton_points(50);
  const auto shifted = halton_points(50, 9);
  const Vec2d shift = shifted[0] - plain[0];
  EXPECT_GT(shift.norm(), 1e-3);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    Vec2d d = shifted[i] - plain[i] - shift;
    d -= d.array().round().matrix();
    EXPECT_LT(d.norm(), 1e-12);  // rounding
    EXPECT_TRUE((shifted[i].array() >= 0).all() && (shifted[i].array() < 1).all());
  }
}

TEST(Relaxation, PartsNeighboursAndKeepsIdentity) {
  const auto before = halton_points(300);
  auto after = before;
  relax_on_torus(after);
  const Spacing a = spacing(before);
  const Spacing b = spacing(after);
  EXPECT_GT(b.least, 1.5 * a.least);
  EXPECT_GT(b.mean, 1.1 * a.mean);
  const double cell = std::sqrt(1.0 / 300);
  for (std::size_t i = 0; i < after.size(); ++i) {
    Vec2d d = after[i] - before[i];
    d -= d.array().round().matrix();
    EXPECT_LT(d.norm(), cell) << "point " << i << " left its own neighbourhood";
  }
}

TEST(Relaxation, IsDeterministicAndStaysInTheUnitSquare) {
  for (const std::size_t count : {1u, 2u, 3u, 7u, 1000u}) {
    auto a = halton_points(count, 5);
    auto b = a;
    relax_on_torus(a);
    relax_on_torus(b);
    EXPECT_EQ(a, b);
    for (const Vec2d& p : a) EXPECT_TRUE((p.array() >= 0).all() && (p.array() < 1).all()) << count;
  }
}

TEST(Relaxation, ARegularLatticeIsAFixedPoint) {
  // Each cell of an 8 × 8 lattice holds 8 × 8 of the 64² sites, symmetric about its point.
  std::vector<Vec2d> lattice;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) lattice.emplace_back((x + 0.5) / 8, (y + 0.5) / 8);
  auto relaxed = lattice;
  relax_on_torus(relaxed, 3);
  for (std::size_t i = 0; i < lattice.size(); ++i)
    EXPECT_LT((relaxed[i] - lattice[i]).norm(), 1e-12);  // rounding
}

TEST(Relaxation, OnePassMovesEveryPointToTheCentroidOfItsCell) {
  // Independent and slow: every site against every point.
  for (const std::size_t count : {std::size_t{2}, std::size_t{5}, std::size_t{60}}) {
    const auto before = halton_points(count, 4);
    auto after = before;
    relax_on_torus(after, 1);
    constexpr int kSide = 500;
    std::vector<Vec2d> sum(count, Vec2d(0, 0));
    std::vector<double> sites(count, 0);
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        std::size_t nearest = 0;
        Vec2d offset(2, 2);
        for (std::size_t i = 0; i < count; ++i) {
          Vec2d d = Vec2d((x + 0.5) / kSide, (y + 0.5) / kSide) - before[i];
          d -= d.array().round().matrix();
          if (d.norm() < offset.norm()) {
            offset = d;
            nearest = i;
          }
        }
        sum[nearest] += offset;
        ++sites[nearest];
      }
    for (std::size_t i = 0; i < count; ++i) {
      Vec2d d = after[i] - before[i] - sum[i] / sites[i];
      d -= d.array().round().matrix();
      // 64 sites a cell or more: a border of about 32 sites, each uncertain by half a site, moves the mean by
      // far less than a tenth of the cell.
      EXPECT_LT(d.norm(), 0.05 / std::sqrt(static_cast<double>(count))) << count;
    }
  }
}

TEST(Relaxation, TakesAHundredThousandPoints) {
  auto points = halton_points(100000);
  relax_on_torus(points, 1);
  for (const Vec2d& p : points) ASSERT_TRUE((p.array() >= 0).all() && (p.array() < 1).all());
}

TEST(ConcentricMap, RoundTripIsExact) {
  for (const Vec2d& p : halton_points(2000)) {
    const Vec2d back = square_from_disc(disc_from_square(p));
    EXPECT_LT((back - p).norm(), 1e-14);  // a few roundings
  }
}

TEST(ConcentricMap, AxesDiagonalsAndCentre) {
  EXPECT_EQ(disc_from_square({0.5, 0.5}).radius2, 0);
  const auto expect = [](const Vec2d& square, double radius2, double turns) {
    const DiscPoint p = disc_from_square(square);
    EXPECT_NEAR(p.radius2, radius2, 1e-15);
    EXPECT_NEAR(p.turns, turns, 1e-15);
  };
  expect({1, 0.5}, 1, 0);
  expect({1, 1}, 1, 0.125);
  expect({0.5, 1}, 1, 0.25);
  expect({0, 0.5}, 1, 0.5);
  expect({0.5, 0}, 1, 0.75);
  expect({1, 0}, 1, 0.875);
  expect({0.75, 0.5}, 0.25, 0);
}

TEST(ConcentricMap, PreservesArea) {
  // A midpoint grid of the square falls evenly into equal-area cells of the disc.
  constexpr int kSide = 512;
  constexpr int kRings = 8, kSectors = 16;
  std::vector<int> hits(kRings * kSectors, 0);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const DiscPoint p = disc_from_square({(x + 0.5) / kSide, (y + 0.5) / kSide});
      ++hits[static_cast<std::size_t>(p.radius2 * kRings) * kSectors +
             static_cast<std::size_t>(p.turns * kSectors)];
    }
  // Each cell holds 2048 grid points; its border, about 4·√2048 long, is uncertain by half a point each.
  for (const int n : hits) EXPECT_NEAR(n, 2048, 100);
}

TEST(ConcentricMap, NeighboursStayNeighbours) {
  const auto on_disc = [](const Vec2d& p) {
    const DiscPoint d = disc_from_square(p);
    return Vec2d(std::sqrt(d.radius2) * std::cos(2 * kPi * d.turns),
                 std::sqrt(d.radius2) * std::sin(2 * kPi * d.turns));
  };
  for (const Vec2d& p : halton_points(3000)) {
    const Vec2d q = p + Vec2d(1e-6, -0.7e-6);
    // The square's half width is the disc's radius; the map stretches lengths by at most 2·√2 · π/2.
    EXPECT_LT((on_disc(p) - on_disc(q)).norm(), 2 * std::sqrt(2.0) * kPi / 2 * 1.3e-6);
  }
}

}  // namespace
}  // namespace lightwell
