// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/evaluation/occluder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lighting/evaluation/evaluate.h"
#include "tests/support/sampling_maps.h"

namespace lightwell {
namespace {

// The arc along a ring and the ray against the body are two computations; they may differ at an outline only.
TEST(Occluder, ArcsOfAzimuthAreWhatRaysMeet) {
  std::mt19937 random(5);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) * 0x1p-32;
  };
  for (const Occluder occluder : kOccluders) {
    int hidden = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vec3d point(uniform(-3, 3), 0, uniform(-3, 3));
      const double theta = uniform(0.001, kPi / 2 - 0.001);
      const AzimuthArc arc = hidden_arc(occluder, point, std::sin(theta), std::cos(theta));
      for (int k = 0; k < 40; ++k) {
        const double lambda = uniform(0, 2 * kPi);
        const double beside = std::abs(std::remainder(lambda - arc.middle_rad, 2 * kPi)) - arc.half_rad;
        if (std::abs(beside) < 1e-7 && arc.half_rad < kPi) continue;  // rounding of either
        const bool meets = hides(occluder, point, direction_from_spherical({theta, lambda}));
        ASSERT_EQ(meets, beside < 0 && arc.half_rad > 0)
            << name(occluder) << " from " << point.transpose() << " theta " << theta << " lambda " << lambda;
        hidden += meets ? 1 : 0;
      }
    }
    EXPECT_GT(hidden, 1000) << name(occluder);
  }
}

// The cosine-weighted solid angle, by the arcs: ∫ 2 half cos θ sin θ dθ = ∫ half d(sin² θ).
TEST(Occluder, HidesOfAUniformSkyWhatItsArcsSum) {
  constexpr int kSteps = 200000;
  for (const Occluder occluder : kOccluders)
    for (const Vec3d& point : {Vec3d(0, 0, 0), Vec3d(0.05, 0, 0.02), Vec3d(0.9, 0, 0.4), Vec3d(-2.1, 0, 1.3),
                               Vec3d(0.3, 0, -2.8), Vec3d(1.5, 0, 0)}) {
      double sum = 0;
      for (int i = 0; i < kSteps; ++i) {
        const double squared_sine = (i + 0.5) / kSteps;
        sum +=
            std::min(
                kPi,
                hidden_arc(occluder, point, std::sqrt(squared_sine), std::sqrt(1 - squared_sine)).half_rad) /
            kSteps;
      }
      // Midpoints where an arc begins like a square root: under kSteps^-1 of π.
      EXPECT_NEAR(hidden_of_uniform_sky(occluder, point), sum, 2e-5) << name(occluder) << point.transpose();
    }
}

TEST(Occluder, NamesAreReadBack) {
  for (const Occluder occluder : kOccluders) EXPECT_EQ(occluder_from_name(name(occluder)), occluder);
  EXPECT_FALSE(occluder_from_name("cone"));
  EXPECT_EQ(occluder_names(), "sphere, box, pole, canopy");
}

TEST(Occluder, EveryBinAsALightHasNoErrorUnderAny) {
  const PolarMap map = test::random_map({13, 31, kPi}, 9);
  LightSet set;
  for (int ring = 0; ring < map.grid.rings; ++ring)
    for (int sector = 0; sector < map.grid.sectors; ++sector) {
      const auto bin = static_cast<std::size_t>(ring * map.grid.sectors + sector);
      set.lights.push_back({map.grid.bin_direction(ring, sector).cast<float>(),
                            map.rgb(bin) * map.solid_angle_sr[bin], -1, 0});
    }
  for (const Occluder occluder : kOccluders) {
    const LightEvaluator evaluator(map, occluder);
    EXPECT_LT(evaluator.error(set).shadow_rel_rmse, 1e-6) << name(occluder);  // float directions
    LightSet half = set;
    for (DirectionalLight& light : half.lights) light.illuminance *= 0.5f;
    EXPECT_NEAR(evaluator.error(half).shadow_rel_rmse, 0.5, 1e-6) << name(occluder);
  }
}

TEST(Occluder, AUniformSkyIsItsAmbientUnderAny) {
  PolarMap map = PolarMap::make({180, 360, kPi / 2}, 1);
  for (float& value : map.radiance) value = 1;
  LightSet ambient;
  ambient.ambient = Rgb::Constant(1);
  for (const Occluder occluder : kOccluders)  // bins of half a degree by one along the outlines
    EXPECT_LT(LightEvaluator(map, occluder).error(ambient).shadow_rel_rmse, 4e-3) << name(occluder);
}

}  // namespace
}  // namespace lightwell
