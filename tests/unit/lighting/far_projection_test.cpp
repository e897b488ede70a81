// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/luminaire/far_projection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lighting/luminaire/lamp_rays.h"
#include "tests/support/analytic_lamps.h"

namespace lightwell {
namespace {

// A Lambertian square of 100 lm: I = 100 / π cos γ.
TEST(FarFieldOf, RaysOfALambertianSquareAreACosine) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  constexpr int kRays = 400000;
  std::vector<LampRay> rays;
  for (int i = 0; i < kRays; ++i) {
    const double sine = std::sqrt(unit(random)), turn = 2 * kPi * unit(random);
    rays.push_back({Vec3d(0.04 * unit(random), 0.04 * unit(random), 0),
                    Vec3d(sine * std::cos(turn), sine * std::sin(turn), -std::sqrt(1 - sine * sine)),
                    100.0 / kRays});
  }
  const FarField far = far_field_of(bin_rays(rays, {4, 16}));
  EXPECT_EQ(far.horizontal_deg.size(), static_cast<std::size_t>(FarGrid{}.planes));
  EXPECT_NEAR(luminous_flux(far), 100, 0.5);
  // 16² pixels have 1560 rays each, 2.5 %; four of them make a value.
  for (const double gamma : {0.0, 20.0, 40.0, 60.0})
    EXPECT_NEAR(intensity(far, PhotometricAngles{33, gamma}) / (100 / kPi * std::cos(gamma * kPi / 180)), 1,
                0.08);
}

// Far away a measured lamp and its far field light alike: the lamp is 1/1000 of the distance wide.
TEST(FarFieldOf, ANearFieldsIntensityIsItsIlluminanceFarAway) {
  LampPlanes planes;
  planes.positions = {7, 5};
  planes.spacing_m = 0.01;
  planes.first_m = Vec2d(-0.03, -0.02);
  planes.pixels = {40, 40};
  planes.low_m = Vec2d::Constant(-0.2);
  planes.high_m = -planes.low_m;
  const test::LampAxis axis{0, 0.12, 0, 0.4, 0.4};
  const test::AnalyticLamp truth{0.1, {{Rgbd::Constant(1e6), {axis, axis}}}};
  const auto ray = [&](const Vec2d& s, const Vec2d& m) { return truth.radiance(s, m); };
  const Luminaire lamp{"", point_sources(measure(ray, planes, BellDual::finite)), std::nullopt};
  const FarField far = far_field_of(lamp);
  EXPECT_EQ(far.vertical_deg.back(), 90) << "nothing shines backward";
  for (const auto& [c, gamma] : {std::pair(0.0, 0.0), std::pair(90.0, 10.0), std::pair(215.0, 25.0)}) {
    const Vec3d direction = photometric_direction(PhotometricSystem::c, {c, gamma});
    const double from_afar = illuminance(lamp, 80 * direction, -direction)[1] * 80 * 80;
    EXPECT_NEAR(intensity(far, PhotometricAngles{c, gamma}) / from_afar, 1, 2e-3);
  }
  EXPECT_NEAR(luminous_flux(far) / luminance(luminous_flux(lamp)), 1, 2e-3);
}

TEST(FarFieldOf, ALampWithoutANearFieldKeepsItsTable) {
  Luminaire lamp;
  lamp.far = FarField{PhotometricSystem::b, {-30, 0, 30}, {-20, 10}, {1, 2, 3, 4, 5, 6}};
  const FarField far = far_field_of(lamp);
  EXPECT_EQ(far.system, PhotometricSystem::b);
  EXPECT_EQ(far.candela, lamp.far->candela);
}

TEST(FarFieldOf, WhatShinesBackwardIsKept) {
  std::vector<LampRay> rays;
  for (int i = 0; i < 1000; ++i)
    rays.push_back({Vec3d::Zero(), Vec3d(std::sin(i), std::cos(i), i % 4 == 0 ? 0.5 : -2).normalized(), 0.1});
  const FarField far = far_field_of(bin_rays(rays, {2, 32}), {36, 91});
  EXPECT_EQ(far.vertical_deg.back(), 180);
  EXPECT_NEAR(luminous_flux(far), 100, 4) << "a thin cone in a table of 2 degrees";
  EXPECT_GT(intensity(far, PhotometricAngles{0, 117}), 1);
}

}  // namespace
}  // namespace lightwell
