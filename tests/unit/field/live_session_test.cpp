// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "field/live_session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lighting/field/polar_turn.h"

namespace lightwell {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

LiveFieldOptions options() {
  LiveFieldOptions o;
  o.grid = {{4, 3, 4}, {-1, 0, -1}, {1, 1, 1}};
  return o;
}

EnvironmentFrame map_of(const std::string& probe, std::uint64_t number, float radiance,
                        const PolarGrid& grid = {.rings = 30, .sectors = 60}) {
  EnvironmentFrame frame;
  frame.header.probe = probe;
  frame.header.number = number;
  frame.header.capture_mono_ns = static_cast<std::int64_t>(number) * 1000;
  frame.map = PolarMap::make(grid, 1);
  std::fill(frame.map.radiance.begin(), frame.map.radiance.end(), radiance);
  return frame;
}

TEST(StageProbe, IsReadAndRefused) {
  const auto probe = parse_stage_probe("left=-1,0.5,2e0");
  ASSERT_TRUE(probe);
  EXPECT_EQ(probe->name, "left");
  EXPECT_EQ(probe->position, Vec3d(-1, 0.5, 2));
  EXPECT_EQ(probe->heading_deg, 0);
  EXPECT_EQ(parse_stage_probe("a=b=1,2,3")->name, "a=b");
  EXPECT_EQ(parse_stage_probe("left=1,2,3,-90")->heading_deg, -90);
  for (const std::string& wrong :
       {std::string("left"), std::string("=1,2,3"), std::string("left=1,2"), std::string("left=1,2,3,4,5"),
        std::string("left=1,2,nan"), std::string("left=1,2,1e9"), std::string("left=1,,2"),
        std::string("l\x1b=1,2,3"), std::string(64, 'x') + "=1,2,3"}) {
    const auto refused = parse_stage_probe(wrong);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_EQ(refused.error().kind, ErrorKind::usage);
  }
}

TEST(LiveSession, SaysOnceWhatHappensToProbes) {
  LiveSession session(options(), {{"left", {-1, 0, 0}}, {"right", {1, 0, 0}}});
  session.make(0);
  EXPECT_THAT(session.news(), IsEmpty());
  session.hear(map_of("left", 1, 2), 0.1);
  session.hear(map_of("other\x1b[2J", 1, 2), 0.1);
  session.hear(map_of("other\x1b[2J", 2, 2), 0.2);
  session.hear(map_of("left", 2, 2), 0.2);
  const auto first = session.news();
  ASSERT_EQ(first.size(), 2u);
  EXPECT_THAT(first[0], HasSubstr("'left' is heard: 30 x 60 bins"));
  EXPECT_THAT(first[1], HasSubstr("without a place"));
  EXPECT_EQ(first[1].find('\x1b'), std::string::npos);
  for (double t = 0.2; t < 6; t += 0.1) session.make(t);
  const auto later = session.news();
  ASSERT_EQ(later.size(), 2u);
  EXPECT_THAT(later[0], HasSubstr("'left' is silent"));
  EXPECT_THAT(later[1], HasSubstr("'right' was not heard yet; on the wire without a place: other"));
  session.hear(map_of("left", 3, 2), 6.1);
  EXPECT_THAT(session.news(), ElementsAre(HasSubstr("'left' is back")));
}

TEST(LiveSession, ATurnedProbesLightIsTurnedBack) {
  // A bright quarter about +Z, the azimuth 0; seen by a probe whose own azimuth 0 points along +X, at its azimuth -90 degrees.
  EnvironmentFrame straight = map_of("left", 1, 1), turned = map_of("left", 1, 1);
  for (std::size_t bin = 0; bin < straight.map.grid.size(); ++bin) {
    const std::size_t sector = bin % 60;
    if (sector < 7 || sector >= 53) straight.map.radiance[bin] = 5;
    if (sector >= 38 && sector < 52) turned.map.radiance[bin] = 5;
  }
  LiveSession a(options(), {{"left", {0, 0, 0}}}), b(options(), {{"left", {0, 0, 0}, 90}});
  a.hear(straight, 0);
  b.hear(turned, 0);
  const FieldFrame& expected = a.make(0);
  const FieldFrame& found = b.make(0);
  ASSERT_EQ(expected.field.radiance.size(), found.field.radiance.size());
  for (std::size_t i = 0; i < expected.field.radiance.size(); ++i)
    ASSERT_NEAR(found.field.radiance[i], expected.field.radiance[i], 1e-4);
}

TEST(PolarTurn, KeepsEachRingsSumAndTurnsByPartsOfASector) {
  PolarMap map = PolarMap::make({.rings = 3, .sectors = 8}, 3), turned;
  for (std::size_t i = 0; i < map.radiance.size(); ++i) map.radiance[i] = static_cast<float>((i * 7) % 11);
  turn_about_zenith(map, 2 * kPi / 8 * 2.25, turned);
  EXPECT_FLOAT_EQ(turned.radiance[2], 0.75f * map.radiance[0] + 0.25f * map.radiance[7]);
  for (std::size_t row = 0; row < map.radiance.size(); row += 8)
    EXPECT_NEAR(std::accumulate(map.radiance.begin() + static_cast<std::ptrdiff_t>(row),
                                map.radiance.begin() + static_cast<std::ptrdiff_t>(row + 8), 0.0),
                std::accumulate(turned.radiance.begin() + static_cast<std::ptrdiff_t>(row),
                                turned.radiance.begin() + static_cast<std::ptrdiff_t>(row + 8), 0.0),
                1e-4);
}

TEST(LiveSession, FieldsSayWhatTheyAreMadeOf) {
  LiveSession session(options(), {{"left", {-1, 0, 0}}, {"right", {1, 0, 0}}});
  EXPECT_FALSE(session.heard_any());
  session.hear(map_of("left", 7, 2), 0.5);
  session.hear(map_of("right", 9, 2, {.rings = 20, .sectors = 90, .theta_max_rad = 1.7}), 0.6);
  EXPECT_TRUE(session.heard_any());
  const FieldFrame& frame = session.make(0.7);
  EXPECT_EQ(frame.header.number, 1u);
  EXPECT_EQ(frame.header.capture_mono_ns, 9000);
  EXPECT_GT(frame.header.measured_part, 0.02f);
  EXPECT_LT(frame.header.measured_part, 0.6f);
  // Light 2 from the wider one's part of the sphere.
  EXPECT_NEAR(frame.header.total_illuminance[1], 2 * 2 * kPi * (1 - std::cos(1.7)), 0.2);
  ASSERT_EQ(frame.probes.size(), 2u);
  EXPECT_EQ(frame.probes[0].number, 7u);
  EXPECT_NEAR(frame.probes[0].age_s, 0.2, 1e-6);
  EXPECT_EQ(frame.probes[1].weight, 1);
  EXPECT_TRUE(frame.lamps.empty());
  EXPECT_EQ(session.make(0.8).header.number, 2u);
}

}  // namespace
}  // namespace lightwell
