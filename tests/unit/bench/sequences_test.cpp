// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/sequences.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bench/painting.h"
#include "lighting/evaluation/coherence.h"

namespace lightwell::bench {
namespace {

TEST(Sequences, EveryFrameIsLightAndTheSameInAnyOrder) {
  for (const Sequence& sequence : sequences()) {
    PolarMap first = sequence_map();
    PolarMap map = sequence_map();
    sequence.draw(17, first);
    for (const int frame : {0, sequence.frames - 1, sequence.frames / 2, 17}) {
      sequence.draw(frame, map);
      for (const float value : map.radiance) ASSERT_TRUE(std::isfinite(value) && value >= 0) << sequence.name;
      EXPECT_GT(luminance(total_illuminance(map)), 0) << sequence.name << frame;
    }
    EXPECT_EQ(map.radiance, first.radiance) << sequence.name;
  }
}

TEST(Sequences, NamesAreDifferentAndFramesEnoughToMeasureALag) {
  std::vector<std::string> names;
  for (const Sequence& sequence : sequences()) {
    names.push_back(sequence.name);
    EXPECT_GE(sequence.frames, 60);
    EXPECT_LE(sequence.frames, 120);
  }
  EXPECT_GE(names.size(), 13u);
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
}

// How strongly the light itself moves, so that nobody weakens a sequence unseen: the shadow image's change from
// frame to frame within a factor of two of what each is made for.
TEST(Sequences, ChangeAsMuchAsTheyAreMadeTo) {
  const EvaluationGeometry geometry(sequence_map().grid);
  for (const Sequence& sequence : sequences()) {
    double expected = 0;
    if (sequence.name.starts_with("noise")) expected = 0.0015;
    if (sequence.name.starts_with("sun")) expected = 0.0083;
    if (sequence.name == "pulsing lamp") expected = 0.0256;
    if (expected == 0) continue;
    PolarMap map = sequence_map();
    CoherenceMeter meter;
    for (int frame = 0; frame < 24; ++frame) {
      sequence.draw(frame, map);
      meter.add(reference_frame(geometry, map), LightSet{});
    }
    const double change = meter.result().shadow.reference_change;
    EXPECT_GT(change, expected / 2) << sequence.name;
    EXPECT_LT(change, expected * 2) << sequence.name;
  }
}

TEST(Painting, ADiscHasItsPowerWhereverItStands) {
  for (const double zenith : {0.0, 0.7, 33.3, 60.0, 89.9})
    for (const double azimuth : {0.0, 0.4, 181.3, 359.9})
      for (const double radius : {0.25, 0.6, 3.0}) {
        PolarMap map = sequence_map();
        add_disc(map, from_degrees(zenith, azimuth), radius, Rgb(3, 2, 1));
        const Rgbd total = total_illuminance(map);
        EXPECT_NEAR(total[0], 3, 1e-4) << zenith << " " << azimuth << " " << radius;  // float radiance
        EXPECT_NEAR(total[2], 1, 1e-4);
      }
}

TEST(Painting, ATurnKeepsThePowerAndWholeSectorsAreExact) {
  PolarMap map = sequence_map();
  paint(map, room_radiance);
  PolarMap turned = sequence_map();
  turn_about_zenith(map, 360, turned);
  EXPECT_EQ(turned.radiance, map.radiance);
  turn_about_zenith(map, 17, turned);
  EXPECT_EQ(turned.plane(1)[360 * 50 + 17 + 30], map.plane(1)[360 * 50 + 30]);
  turn_about_zenith(map, 12.3, turned);
  EXPECT_NEAR(luminance(total_illuminance(turned)) / luminance(total_illuminance(map)), 1, 1e-6);  // floats
}

TEST(Painting, ACameraThatIsNotTurnedSeesTheMapAndOneTurnedAboutTheZenithTheTurnedMap) {
  PolarMap sphere = PolarMap::make({180, 360, kPi}, 3);
  paint(sphere, room_radiance);
  const TurnedView view(sphere, sequence_map().grid);
  PolarMap map = sequence_map();
  view.look({0, 0, 0}, map);
  for (std::size_t bin = 0; bin < map.grid.size(); ++bin)  // float angles times 9000 cd/m² a bin
    ASSERT_NEAR(map.plane(0)[bin], sphere.plane(0)[bin], 0.5);
  view.look({0, 40 * kPi / 180, 0}, map);
  for (std::size_t ring = 0; ring < 90; ring += 7)
    for (std::size_t sector = 0; sector < 360; sector += 11)
      ASSERT_NEAR(map.plane(0)[ring * 360 + sector], sphere.plane(0)[ring * 360 + (sector + 40) % 360], 0.5);
}

TEST(Painting, NoiseHasItsSigmaAndNoBias) {
  PolarMap map = sequence_map();
  std::fill(map.radiance.begin(), map.radiance.end(), 1.0f);
  add_relative_noise(map, 0.05, 3);
  double sum = 0, squares = 0;
  for (const float value : map.radiance) {
    sum += static_cast<double>(value) - 1;
    squares += (static_cast<double>(value) - 1) * (static_cast<double>(value) - 1);
  }
  const auto n = static_cast<double>(map.radiance.size());
  EXPECT_LT(std::abs(sum / n), 4 * 0.05 / std::sqrt(n));                   // four standard errors of the mean
  EXPECT_NEAR(std::sqrt(squares / n), 0.05, 4 * 0.05 / std::sqrt(2 * n));  // and of the deviation
}

}  // namespace
}  // namespace lightwell::bench
