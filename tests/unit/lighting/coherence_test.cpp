// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/evaluation/coherence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/sampling_maps.h"

namespace lightwell {
namespace {

const PolarGrid kGrid{9, 24, kPi / 2};

using test::every_bin_a_light;

PolarMap scaled(const PolarMap& map, double factor) {
  PolarMap result = map;
  for (float& value : result.radiance) value *= static_cast<float>(factor);
  return result;
}

// Runs maps and sets of each frame through a meter.
Coherence measure(const std::vector<PolarMap>& maps, const std::vector<LightSet>& sets) {
  const EvaluationGeometry geometry(maps.front().grid);
  CoherenceMeter meter;
  for (std::size_t t = 0; t < maps.size(); ++t) meter.add(reference_frame(geometry, maps[t]), sets[t]);
  return meter.result();
}

TEST(Coherence, LightsThatAreTheMapHaveNeitherErrorNorExcessNorLag) {
  std::vector<PolarMap> maps;
  std::vector<LightSet> sets;
  for (int t = 0; t < 48; ++t) {
    maps.push_back(scaled(test::sun_and_sky(kGrid, 15.0 * t, 40, 0.5), 1 + 0.3 * std::sin(0.4 * t)));
    sets.push_back(every_bin_a_light(maps.back()));
  }
  const Coherence c = measure(maps, sets);
  EXPECT_EQ(c.frames, 48u);
  for (const Steadiness& s : {c.shadow, c.irradiance}) {
    EXPECT_LT(s.error, 1e-6);  // float directions
    EXPECT_LT(s.excess, 1e-6);
    EXPECT_LT(s.change_error, 1e-6);
    EXPECT_GT(s.reference_change, 0.01);
  }
  EXPECT_NEAR(c.power_lag_frames, 0, 0.05);  // the parabola, where the swing is no whole number of periods
  EXPECT_NEAR(c.direction_lag_frames, 0, 0.05);
}

// One light that stands for a still map, and whose power alternates by ± a: shadow and irradiance of the lights
// change by 2a of themselves every frame, all of it excess.
TEST(Coherence, FlickerOverAStillMapIsAllExcess) {
  PolarMap map = PolarMap::make({1, 1, kPi / 2}, 3);
  map.radiance = {1, 1, 1};
  constexpr double kA = 0.05;
  std::vector<PolarMap> maps(40, map);
  std::vector<LightSet> sets;
  for (int t = 0; t < 40; ++t) {
    sets.push_back(every_bin_a_light(map));
    sets.back().lights[0].illuminance *= static_cast<float>(t % 2 == 0 ? 1 + kA : 1 - kA);
  }
  const Coherence c = measure(maps, sets);
  for (const Steadiness& s : {c.shadow, c.irradiance}) {
    EXPECT_NEAR(s.error, kA, 1e-6);  // floats
    EXPECT_EQ(s.reference_change, 0);
    EXPECT_NEAR(s.excess, 2 * kA, 1e-6);
    EXPECT_NEAR(s.change_error, 2 * kA, 1e-6);
    EXPECT_NEAR(s.largest_excess, 2 * kA, 1e-6);
  }
  EXPECT_TRUE(std::isnan(c.power_lag_frames));  // nothing to follow
}

// A map whose power swings, lights that repeat it d frames later: as restless as the light, so no excess, but the
// changes are not the light's, and the lag is d.
TEST(Coherence, DelayIsNoExcessButALagAndAnErrorOfTheChange) {
  const PolarMap still = test::random_map(kGrid, 3);
  constexpr int kDelay = 4;
  std::vector<PolarMap> maps;
  std::vector<LightSet> sets;
  for (int t = 0; t < 96; ++t) {
    maps.push_back(scaled(still, 1 + 0.05 * std::sin(2 * kPi * t / 24.0)));
    sets.push_back(every_bin_a_light(scaled(still, 1 + 0.05 * std::sin(2 * kPi * (t - kDelay) / 24.0))));
  }
  const Coherence c = measure(maps, sets);
  EXPECT_NEAR(c.power_lag_frames, kDelay, 0.01);  // a sine's valley is a parabola to the square of its step
  EXPECT_TRUE(std::isnan(c.direction_lag_frames));
  EXPECT_LT(c.shadow.excess,
            0.02 * c.shadow.reference_change);  // ‖M‖ of 5 % more or less, in another phase
  EXPECT_GT(c.shadow.change_error, 0.5 * c.shadow.reference_change);
}

TEST(Coherence, PrefixIsMeasuredAsAReaderTakesIt) {
  const PolarMap map = test::random_map(kGrid, 5);
  const EvaluationGeometry geometry(kGrid);
  const ReferenceFrame reference = reference_frame(geometry, map);
  const LightSet set = every_bin_a_light(map);
  CoherenceMeter prefix(Occluder::sphere, 20), taken;
  prefix.add(reference, set);
  taken.add(reference, take_lights(set, 20));
  EXPECT_EQ(prefix.result().shadow.error, taken.result().shadow.error);
  EXPECT_GT(prefix.result().shadow.error, 0.01);
}

TEST(Coherence, BlackFramesAreLeftOutAndEndTheComparison) {
  const PolarMap map = test::random_map(kGrid, 6);
  const PolarMap black = PolarMap::make(kGrid, 3);
  const LightSet set = every_bin_a_light(map);
  const LightSet twice = every_bin_a_light(scaled(map, 2));
  const Coherence c = measure({map, black, scaled(map, 2)}, {set, LightSet{}, twice});
  EXPECT_EQ(c.frames, 2u);
  EXPECT_EQ(c.shadow.change, 0);
  EXPECT_LT(c.shadow.error, 1e-6);  // float directions
}

TEST(Coherence, DoesNotDependOnTheScaleOfTheLight) {
  const PolarMap map = test::random_map(kGrid, 7);
  LightSet few = every_bin_a_light(map);
  few.lights.resize(100);
  for (const double scale : {1e-30, 1e25}) {
    LightSet set = few;
    for (DirectionalLight& light : set.lights) light.illuminance *= static_cast<float>(scale);
    const Coherence c = measure({scaled(map, scale), scaled(map, scale)}, {set, set});
    const Coherence expected = measure({map, map}, {few, few});
    EXPECT_NEAR(c.shadow.error, expected.shadow.error, 1e-6);  // floats
  }
}

TEST(Coherence, ReferenceFrameSumsPowerAndMeanDirectionOfEveryBin) {
  const PolarMap map = test::random_map({7, 11, kPi}, 8);
  double power = 0;
  Vec3d moment = Vec3d::Zero();
  for (const DirectionalLight& light : every_bin_a_light(map).lights) {
    const double flux = luminance(Rgbd(light.illuminance.cast<double>()));
    power += flux;
    moment += flux * light.direction.cast<double>();
  }
  const ReferenceFrame frame = reference_frame(EvaluationGeometry(map.grid), map);
  EXPECT_NEAR(frame.power / power, 1, 1e-6);  // float illuminances and directions
  EXPECT_LT((frame.direction - moment / power).norm(), 1e-6);
}

}  // namespace
}  // namespace lightwell
