// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/luminaire/lamp_rays.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace lightwell {
namespace {

TEST(HemisphereMap, IsItsOwnInverseAndKeepsAreas) {
  for (double x = -0.99; x < 1; x += 0.07)
    for (double y = -0.99; y < 1; y += 0.07) {
      const Vec3d d = direction_from_square({x, y});
      EXPECT_NEAR(d.norm(), 1, 1e-12);
      EXPECT_LE(d.z(), 0);
      EXPECT_LT((square_from_direction(d) - Vec2d(x, y)).norm(), 1e-12);
    }
  EXPECT_LT((square_from_direction(-Vec3d::UnitZ())).norm(), 1e-12);
  // Even directions fill the square evenly.
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  std::array<int, 16> count{};
  constexpr int kRays = 160000;
  for (int i = 0; i < kRays; ++i) {
    const double z = -unit(random), turn = 2 * kPi * unit(random), sine = std::sqrt(1 - z * z);
    const Vec2d place = square_from_direction({sine * std::cos(turn), sine * std::sin(turn), z});
    ++count[static_cast<std::size_t>(std::min(3, static_cast<int>((place.y() + 1) * 2)) * 4 +
                                     std::min(3, static_cast<int>((place.x() + 1) * 2)))];
  }
  for (const int n : count) EXPECT_NEAR(n, kRays / 16, 6 * std::sqrt(kRays / 16.0));
}

// A Lambertian square of 4 cm, 100 lm, and a part of its rays that leave backward.
std::vector<LampRay> square_lamp(int count, double backward) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<LampRay> rays;
  for (int i = 0; i < count; ++i) {
    const double sine = std::sqrt(unit(random)), turn = 2 * kPi * unit(random);
    const double z = std::sqrt(1 - sine * sine);
    rays.push_back({Vec3d(0.04 * unit(random) - 0.02, 0.04 * unit(random) - 0.02, 0.003),
                    Vec3d(sine * std::cos(turn), sine * std::sin(turn), unit(random) < backward ? z : -z),
                    100.0 / count});
  }
  return rays;
}

double exact_square(const Vec3d& point, double flux) {
  constexpr int kSteps = 80;
  double sum = 0;
  for (int j = 0; j < kSteps; ++j)
    for (int i = 0; i < kSteps; ++i) {
      const Vec3d way =
          point - Vec3d(-0.02 + 0.04 * (i + 0.5) / kSteps, -0.02 + 0.04 * (j + 0.5) / kSteps, 0.003);
      sum += way.z() * way.z() / (way.squaredNorm() * way.squaredNorm());
    }
  return flux / kPi * sum / (kSteps * kSteps);
}

TEST(LampOfRays, LightsPlanesNearAndFarAsTheLampDoes) {
  const Luminaire lamp = bin_rays(square_lamp(400000, 0), {8, 24});
  for (const double distance : {0.04, 0.1, 0.3, 1.0}) {
    double error = 0, norm = 0;
    for (const double x : {0.0, 0.3, -0.5})
      for (const double y : {0.0, 0.4}) {
        const Vec3d point(x * distance, y * distance, 0.003 - distance);
        const double exact = exact_square(point, 100);
        error += std::pow(illuminance(lamp, point, Vec3d::UnitZ())[1] - exact, 2);
        norm += exact * exact;
      }
    EXPECT_LT(std::sqrt(error / norm), 0.03) << distance;
  }
}

TEST(LampOfRays, LosesNoFlux) {
  EXPECT_NEAR(luminous_flux(bin_rays(square_lamp(20000, 0.3), {8, 24}))[1], 100, 0.01);
  EXPECT_NEAR(luminous_flux(bin_rays(square_lamp(1, 0), {8, 24}))[1], 100, 0.01) << "a single ray";
  EXPECT_NEAR(luminous_flux(bin_rays(square_lamp(100, 1), {8, 24}))[1], 100, 0.01) << "all of it backward";
}

TEST(LampOfRays, ALineOfLightIsAsWideAsALine) {
  std::vector<LampRay> rays = square_lamp(10000, 0);
  for (LampRay& ray : rays) ray.origin_m.y() = 0.01;
  const Luminaire lamp = bin_rays(rays, {8, 16});
  const LampPlanes& planes = lamp.near->intensity.planes;
  EXPECT_EQ(planes.positions[0], 64) << "as many as a square has, all along it";
  EXPECT_EQ(planes.positions[1], 1);
  EXPECT_NEAR(planes.first_m.y(), 0.01, 1e-9);
  EXPECT_NEAR(planes.z_m, 0.003, 1e-12);
}

TEST(LampOfRays, ASquareHasAsManyPositionsEachWay) {
  const std::vector<LampRay> rays = square_lamp(20000, 0);
  for (int positions = 2; positions <= 9; ++positions)
    EXPECT_EQ(bin_rays(rays, {positions, 8}).near->intensity.planes.positions,
              (std::array{positions, positions}));
}

// Flux, and the place of the light's mean, of lamps of any proportion on grids of no more than positions².
TEST(LampOfRays, StandsWhereTheLightIs) {
  for (const double wide : {0.0, 0.005, 0.02, 0.05, 0.15, 0.3, 0.8, 2.0, 20.0}) {
    std::vector<LampRay> rays = square_lamp(20000, 0);
    double mean = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      // Brighter on one side, so that mean and middle are two things.
      const double part = (rays[i].origin_m.y() + 0.02) / 0.04;
      rays[i].origin_m.y() = 0.04 * wide * part * part;
      mean += rays[i].origin_m.y() / static_cast<double>(rays.size());
    }
    const Luminaire lamp = bin_rays(rays, {8, 8});
    const LampImages& images = lamp.near->intensity;
    EXPECT_LE(images.planes.images(), 64u) << wide;
    EXPECT_GE(images.planes.images(), 22u) << wide << ": one row, where 22 x 3 would be too many";
    double flux = 0, at = 0;
    for (int v = 0; v < images.planes.positions[1]; ++v)
      for (int u = 0; u < images.planes.positions[0]; ++u)
        for (std::size_t i = 0; i < images.planes.image_size(); ++i) {
          const auto of_pixel = static_cast<double>(images.image(u, v)[i][1]);
          flux += of_pixel;
          at += of_pixel * images.planes.position(u, v).y();
        }
    // What little lies outside the positions is moved in.
    EXPECT_NEAR(at / flux, mean, 1e-3 * 0.04 * wide + 1e-9) << wide;
    EXPECT_NEAR(luminous_flux(lamp)[1], 100, 0.01) << wide;
  }
}

// Lambertian, 100 lm, over what a unit square is mapped to. Roberts' additive recurrence in four dimensions: even, so that
// squares of a plane have little noise.
template <class Place>
std::vector<LampRay> even_rays(int count, const Place& place) {
  const double root = 1.1673039782614187;  // x⁵ = x + 1
  std::vector<LampRay> rays;
  for (int i = 1; i <= count; ++i) {
    std::array<double, 4> at{};
    for (std::size_t k = 0; k < 4; ++k)
      at[k] = std::fmod(0.5 + i * std::pow(root, -static_cast<double>(k + 1)), 1.0);
    const double sine = std::sqrt(at[0]), turn = 2 * kPi * at[1];
    const Vec2d from = place(at[2], at[3]);
    rays.push_back({Vec3d(from.x(), from.y(), 0),
                    Vec3d(sine * std::cos(turn), sine * std::sin(turn), -std::sqrt(1 - sine * sine)),
                    100.0 / count});
  }
  return rays;
}

// Relative RMSE of illuminance against the rays' own flux in 10² rectangles of a plane.
double error_on_plane(const std::vector<LampRay>& rays, const Luminaire& lamp, double distance,
                      const Vec2d& half_m) {
  constexpr int kBins = 10, kPoints = 3;
  const Vec2d bin = 2 * half_m / kBins;
  std::array<double, kBins * kBins> exact{};
  for (const LampRay& ray : rays) {
    const Vec3d at = ray.origin_m - ray.direction * (distance / ray.direction.z());
    const Vec2d place = (at.head<2>() + half_m).cwiseQuotient(bin).array().floor();
    if ((place.array() >= 0).all() && (place.array() < kBins).all())
      exact[static_cast<std::size_t>(place.y() * kBins + place.x())] += ray.flux_lm / bin.prod();
  }
  double error = 0, norm = 0;
  for (int y = 0; y < kBins; ++y)
    for (int x = 0; x < kBins; ++x) {
      double mean = 0;
      for (int k = 0; k < kPoints * kPoints; ++k) {
        const Vec2d place =
            Vec2d(x + (k % kPoints + 0.5) / kPoints, y + (k / kPoints + 0.5) / kPoints).cwiseProduct(bin) -
            half_m;
        mean += illuminance(lamp, Vec3d(place.x(), place.y(), -distance), Vec3d::UnitZ())[1] /
                (kPoints * kPoints);
      }
      const double truth = exact[static_cast<std::size_t>(y * kBins + x)];
      error += (mean - truth) * (mean - truth);
      norm += truth * truth;
    }
  return std::sqrt(error / norm);
}

struct Source {
  const char* name;
  Vec2d (*place)(double, double);
  Vec2d half_m;  // of its outline
};
constexpr int kEvenRays = 400000;
const std::array<Source, 4> kSources = {
    Source{"tube", [](double a, double b) { return Vec2d(1.2 * (a - 0.5), 0.02 * (b - 0.5)); }, {0.6, 0.01}},
    Source{"tube along y",
           [](double a, double b) { return Vec2d(0.02 * (a - 0.5), 1.2 * (b - 0.5)); },
           {0.01, 0.6}},
    Source{
        "square", [](double a, double b) { return Vec2d(0.04 * (a - 0.5), 0.04 * (b - 0.5)); }, {0.02, 0.02}},
    Source{"disc",
           [](double a, double b) {
             return Vec2d(0.05 * std::sqrt(a) * Vec2d(std::cos(2 * kPi * b), std::sin(2 * kPi * b)));
           },
           {0.05, 0.05}}};

// Reach: 3 % at .1, .3 and 1 m; of it 1 to 2 % at .1 m are the rays' own noise in a rectangle.
TEST(LampOfRays, LightsPlanesAsItsRaysDo) {
  for (const Source& source : kSources) {
    const std::vector<LampRay> rays = even_rays(kEvenRays, source.place);
    for (const int positions : {8, 16}) {
      const Luminaire lamp = bin_rays(rays, {positions, 32});
      for (const double distance : {0.1, 0.3, 1.0})
        for (const double beyond : {0.0, 1.0}) {  // before its middle, and all of it
          const Vec2d half = Vec2d::Constant(distance) + beyond * source.half_m;
          EXPECT_LT(error_on_plane(rays, lamp, distance, half), 0.03)
              << source.name << ", " << positions << " positions, " << distance << " m";
        }
    }
  }
}

// Straight below, the hemisphere's map onto the square has a kink, and the noise between its pixels one with it: the
// positions see it on either side, .001 apart at 5 m.
TEST(LampOfRays, FarLightIsTheSameAtEverySubdivision) {
  const Luminaire lamp = bin_rays(square_lamp(20000, 0), {9, 16});
  for (const auto& [point, bound] : {std::pair(Vec3d(1, 2, -5), 1e-6), std::pair(Vec3d(-3, 1, -5), 1e-6),
                                     std::pair(Vec3d(0, 0, -5), 2e-5), std::pair(Vec3d(0, 0, -500), 2e-7)}) {
    const double plain = illuminance(*lamp.near, point, Vec3d::UnitZ(), 1)[1];
    for (int subdivision = 2; subdivision <= 16; ++subdivision)
      EXPECT_NEAR(illuminance(*lamp.near, point, Vec3d::UnitZ(), subdivision)[1] / plain, 1, bound)
          << point.transpose() << ", " << subdivision;
  }
}

TEST(LampOfRays, IsRightFromItsNearestPlaneOn) {
  const std::array<Source, 4> large = {
      Source{
          "square", [](double a, double b) { return Vec2d(0.6 * (a - 0.5), 0.6 * (b - 0.5)); }, {0.3, 0.3}},
      Source{"panel", [](double a, double b) { return Vec2d(1.2 * (a - 0.5), 0.6 * (b - 0.5)); }, {0.6, 0.3}},
      Source{"wide tube",
             [](double a, double b) { return Vec2d(1.2 * (a - 0.5), 0.06 * (b - 0.5)); },
             {0.6, 0.03}},
      kSources[0]};
  for (const Source& source : large) {
    const std::vector<LampRay> rays = even_rays(kEvenRays, source.place);
    const Luminaire lamp = bin_rays(rays, {8, 32});
    const double nearest = nearest_m(lamp.near->intensity.planes);
    const auto error = [&](double distance) {
      return error_on_plane(rays, lamp, distance, source.half_m + Vec2d::Constant(distance));
    };
    EXPECT_LT(error(nearest), 0.03) << source.name << ", " << nearest << " m";
    EXPECT_GT(error(nearest / 4), 0.03) << source.name << ": the bound says nothing where nearer is as good";
  }
}

}  // namespace
}  // namespace lightwell
