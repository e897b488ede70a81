// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/luminaire/lamp_rays.h"

#include <gtest/gtest.h>

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
  EXPECT_EQ(planes.positions[0], 8);
  EXPECT_EQ(planes.positions[1], 1);
  EXPECT_NEAR(planes.first_m.y(), 0.01, 1e-9);
  EXPECT_NEAR(planes.z_m, 0.003, 1e-12);
}

}  // namespace
}  // namespace lightwell
