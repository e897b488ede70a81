// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/dds_wire.h"

#include <dds/dds.h>
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>

#include "interface/dds_topics.h"
#include "tests/support/dds.h"

namespace lightwell {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A good frame of two lights as a stranger would send it; the tests spoil one thing each.
struct Lights {
  lightwell_Light lights[2] = {{{0, 1, 0}, {1, 2, 3}, 1, -1, 0.5f, 0.1f}, {{1, 0, 0}, {1, 2, 3}, 2, 0, 0, 0}};
  float harmonics[75] = {1, 2, 3};
  lightwell_LightFrame frame{};
  Lights() {
    std::strcpy(frame.probe, "stranger");
    frame.has_parents = true;
    frame.lights = {2, 2, lights, false};
    frame.harmonics = {75, 75, harmonics, false};
  }
};

struct Fit {
  lightwell_FittedLight lights[2] = {{{0, 1, 0}, {1, 2, 3}, 1, 0.1f}, {{1, 0, 0}, {1, 2, 3}, 2, kInfinity}};
  lightwell_FitFrame frame{};
  Fit() {
    std::strcpy(frame.probe, "stranger");
    std::strcpy(frame.remarks, "1 light merged");
    frame.residual = 0.02f;
    frame.lights = {2, 2, lights, false};
  }
};

struct Map {
  std::uint16_t halves[12] = {};
  lightwell_EnvironmentFrame frame{};
  Map() {
    std::strcpy(frame.probe, "stranger");
    frame.rings = 3;
    frame.sectors = 4;
    frame.channels = 1;
    frame.theta_max_rad = 1.5f;
    frame.scale = 1;
    frame.half_radiance = {12, 12, halves, false};
  }
};

struct Field {
  std::uint16_t halves[96] = {0xbc00, 0x3c00};  // 2 × 2 × 2 points of degree 1; -1, 1
  std::uint8_t confidence[8] = {0, 255};
  lightwell_FieldProbe probes[1] = {{"a", {1, 2, 3}, 7, 0.1f, 1}};
  lightwell_FieldLamp lamps[1] = {{3, {1, 2, 3}, 0.1f, {10, 20, 30}, 1}};
  lightwell_FieldFrame frame{};
  Field() {
    std::strcpy(frame.probe, "stranger");
    for (int a = 0; a < 3; ++a) {
      frame.size[a] = 2;
      frame.high[a] = 1;
    }
    frame.degree = 1;
    frame.scale = 2;
    frame.half_radiance = {96, 96, halves, false};
    frame.confidence = {8, 8, confidence, false};
    frame.probes = {1, 1, probes, false};
    frame.lamps = {1, 1, lamps, false};
  }
};

TEST(DdsWire, GoodMessagesOfAStrangerAreRead) {
  LightFrame lights;
  EXPECT_EQ(from_wire(Lights().frame, lights), "");
  EXPECT_EQ(lights.header.probe, "stranger");
  ASSERT_EQ(lights.lights.size(), 2u);
  EXPECT_EQ(lights.lights[0].predicted_error, 0.5f);
  EXPECT_EQ(lights.lights[1].predicted_error, 0);  // not said, as by a writer that does not know of it
  ASSERT_EQ(lights.harmonics.size(), 25u);
  EXPECT_TRUE((lights.harmonics[0] == Rgb(1, 2, 3)).all());
  Lights older;  // whose writer knows no harmonics
  older.frame.harmonics = {};
  EXPECT_EQ(from_wire(older.frame, lights), "");
  EXPECT_TRUE(lights.harmonics.empty());
  FitFrame fit;
  EXPECT_EQ(from_wire(Fit().frame, fit), "");
  EXPECT_EQ(fit.remarks, "1 light merged");
  EXPECT_EQ(fit.lights[1].direction_sigma_rad, kInfinity);
  EnvironmentFrame map;
  EXPECT_EQ(from_wire(Map().frame, map), "");
  EXPECT_EQ(map.map.grid.rings, 3);
}

TEST(DdsWire, MalformedLightsAreRefusedAndLeaveTheMessageAlone) {
  const std::function<void(Lights&)> spoilers[] = {
      [](Lights& l) { l.lights[1].direction[0] = kNan; },
      [](Lights& l) { l.lights[1].direction[0] = 1.01f; },
      [](Lights& l) { l.lights[1].direction[0] = 0; },
      [](Lights& l) { l.lights[0].direction[1] = kInfinity; },
      [](Lights& l) { l.lights[0].illuminance[2] = kNan; },
      [](Lights& l) { l.lights[0].illuminance[2] = kInfinity; },
      [](Lights& l) { l.lights[0].illuminance[2] = -1; },
      [](Lights& l) { l.lights[0].parent = 0; },
      [](Lights& l) { l.lights[1].parent = 1; },
      [](Lights& l) { l.lights[1].parent = -1; },
      [](Lights& l) { l.lights[1].predicted_error = kNan; },
      [](Lights& l) { l.lights[1].predicted_error = kInfinity; },
      [](Lights& l) { l.lights[1].predicted_error = -1e-3f; },
      [](Lights& l) { l.lights[1].angular_radius_rad = kNan; },
      [](Lights& l) { l.lights[1].angular_radius_rad = -1e-3f; },
      [](Lights& l) { l.lights[1].angular_radius_rad = 3.2f; },
      [](Lights& l) { l.frame.ambient[0] = kNan; },
      [](Lights& l) { l.frame.header.total_illuminance[0] = -1; },
      [](Lights& l) { l.frame.header.measured_part = 1.5f; },
      [](Lights& l) { l.frame.header.measured_part = kNan; },
      [](Lights& l) { l.frame.header.delay_frames = kInfinity; },
      [](Lights& l) { std::strcpy(l.frame.header.timecode, "\x1b[2J"); },
      [](Lights& l) { l.frame.lights._length = 1u << 20; },
      [](Lights& l) { l.frame.harmonics._length = 74; },
      [](Lights& l) { l.harmonics[74] = kNan; },
  };
  int index = 0;
  for (const auto& spoil : spoilers) {
    Lights spoilt;
    spoil(spoilt);
    LightFrame message;
    message.header.number = 99;
    EXPECT_NE(from_wire(spoilt.frame, message), "") << "spoiler " << index;
    EXPECT_EQ(message.header.number, 99u);
    EXPECT_TRUE(message.lights.empty());
    ++index;
  }
}

TEST(DdsWire, MalformedFitsAreRefusedAndLeaveTheMessageAlone) {
  const std::function<void(Fit&)> spoilers[] = {
      [](Fit& f) { f.lights[1].direction[0] = kNan; },
      [](Fit& f) { f.lights[1].direction[0] = 0.5f; },
      [](Fit& f) { f.lights[0].illuminance[2] = -1; },
      [](Fit& f) { f.lights[0].illuminance[2] = kInfinity; },
      [](Fit& f) { f.lights[0].direction_sigma_rad = kNan; },
      [](Fit& f) { f.lights[0].direction_sigma_rad = -1; },
      [](Fit& f) { f.frame.ambient[1] = kNan; },
      [](Fit& f) { f.frame.residual = -0.1f; },
      [](Fit& f) { f.frame.residual = kNan; },
      [](Fit& f) { f.frame.header.measured_part = 2; },
      [](Fit& f) { std::strcpy(f.frame.remarks, "\x1b[2J"); },
      [](Fit& f) { f.frame.lights._length = 17; },
  };
  int index = 0;
  for (const auto& spoil : spoilers) {
    Fit spoilt;
    spoil(spoilt);
    FitFrame message;
    message.header.number = 99;
    EXPECT_NE(from_wire(spoilt.frame, message), "") << "spoiler " << index;
    EXPECT_EQ(message.header.number, 99u);
    EXPECT_TRUE(message.lights.empty());
    ++index;
  }
}

TEST(DdsWire, MalformedMapsAreRefused) {
  const std::function<void(Map&)> spoilers[] = {
      [](Map& m) { m.frame.rings = 0; },
      [](Map& m) { m.frame.rings = 4; },
      [](Map& m) { m.frame.rings = 0x80000003; },
      [](Map& m) { m.frame.sectors = 0xffffffff; },
      [](Map& m) { m.frame.channels = 2; },
      [](Map& m) { m.frame.channels = 3; },
      [](Map& m) { m.frame.theta_max_rad = kNan; },
      [](Map& m) { m.frame.theta_max_rad = 3.2f; },
      [](Map& m) { m.frame.theta_max_rad = 0; },
      [](Map& m) { m.frame.scale = 0; },
      [](Map& m) { m.frame.scale = kNan; },
      [](Map& m) { m.frame.scale = 1e38f; },
      [](Map& m) { m.halves[5] = 0x7c00; },
      [](Map& m) { m.halves[5] = 0x7e00; },
      [](Map& m) { m.halves[5] = 0xbc00; },
  };
  int index = 0;
  for (const auto& spoil : spoilers) {
    Map spoilt;
    spoil(spoilt);
    EnvironmentFrame message;
    EXPECT_NE(from_wire(spoilt.frame, message), "") << "spoiler " << index;
    EXPECT_TRUE(message.map.radiance.empty());
    ++index;
  }
}

TEST(DdsWire, FieldOfAStrangerIsRead) {
  FieldFrame field;
  ASSERT_EQ(from_wire(Field().frame, field), "");
  EXPECT_EQ(field.field.grid.points(), 8u);
  EXPECT_EQ(field.field.radiance[0], -2);
  EXPECT_EQ(field.field.radiance[1], 2);
  EXPECT_EQ(field.field.confidence[1], 1);
  ASSERT_EQ(field.probes.size(), 1u);
  EXPECT_EQ(field.probes[0].position, Vec3d(1, 2, 3));
  ASSERT_EQ(field.lamps.size(), 1u);
  EXPECT_EQ(field.lamps[0].intensity[2], 30);
}

TEST(DdsWire, MalformedFieldsAreRefusedAndLeaveTheMessageAlone) {
  const std::function<void(Field&)> spoilers[] = {
      [](Field& f) { f.frame.size[1] = 1; },
      [](Field& f) { f.frame.size[1] = 3; },
      [](Field& f) { f.frame.size[0] = 0xffffffff; },
      [](Field& f) { f.frame.low[2] = kNan; },
      [](Field& f) { f.frame.high[2] = kInfinity; },
      [](Field& f) { f.frame.high[2] = 0; },
      [](Field& f) { f.frame.degree = 0; },
      [](Field& f) { f.frame.degree = 9; },
      [](Field& f) { f.frame.degree = 2; },
      [](Field& f) { f.frame.scale = kNan; },
      [](Field& f) { f.frame.scale = -1; },
      [](Field& f) { f.halves[95] = 0x7c00; },
      [](Field& f) { f.halves[95] = 0xfe00; },
      [](Field& f) { f.frame.half_radiance._length = 95; },
      [](Field& f) { f.frame.confidence._length = 7; },
      [](Field& f) { f.frame.probes._length = 65; },
      [](Field& f) { f.probes[0].position[1] = kNan; },
      [](Field& f) { f.probes[0].age_s = -1; },
      [](Field& f) { f.probes[0].weight = 1.5f; },
      [](Field& f) { std::strcpy(f.probes[0].probe, "\x1b[2J"); },
      [](Field& f) { f.lamps[0].position[1] = kInfinity; },
      [](Field& f) { f.lamps[0].sigma_m = kNan; },
      [](Field& f) { f.lamps[0].intensity[1] = -1; },
      [](Field& f) { f.lamps[0].weight = kNan; },
      [](Field& f) { f.frame.header.measured_part = 2; },
  };
  int index = 0;
  for (const auto& spoil : spoilers) {
    Field spoilt;
    spoil(spoilt);
    FieldFrame message;
    message.header.number = 99;
    EXPECT_NE(from_wire(spoilt.frame, message), "") << "spoiler " << index;
    EXPECT_EQ(message.header.number, 99u);
    EXPECT_TRUE(message.field.radiance.empty());
    ++index;
  }
}

TEST(DdsWire, NearlyUnitDirectionsBecomeUnit) {
  Lights sent;
  sent.lights[0].direction[1] = 1.0005f;
  LightFrame message;
  ASSERT_EQ(from_wire(sent.frame, message), "");
  EXPECT_FLOAT_EQ(message.lights[0].direction.norm(), 1.0f);
}

TEST(DdsWire, HugeRadianceAndTinyRadianceSurviveTheScale) {
  for (const float value : {1e-30f, 1e-6f, 1.0f, 65504.0f, 1e30f}) {
    EnvironmentFrame sent;
    sent.map = PolarMap::make({.rings = 1, .sectors = 1}, 1);
    sent.map.radiance[0] = value;
    lightwell_EnvironmentFrame wire{};
    std::vector<std::uint16_t> buffer;
    ASSERT_EQ(to_wire(sent, wire, buffer), "");
    EnvironmentFrame received;
    ASSERT_EQ(from_wire(wire, received), "") << value;
    // 11 significant bits.
    EXPECT_NEAR(received.map.radiance[0], value, value * 0x1p-11f);
  }
}

// Over the network too: a reader counts what it refuses, says why, and goes on.
TEST(DdsWire, ReaderRefusesAStrangersNonsense) {
  const auto domain = DdsDomain::open(test::own_domain()).value();
  const auto reader = LightReader::create(domain).value();
  const dds_entity_t topic = dds_create_topic(domain->participant(), &lightwell_LightFrame_desc,
                                              "lightwell/LightFrame", nullptr, nullptr);
  ASSERT_GT(topic, 0);
  dds_qos_t* qos = dds_create_qos();  // readers ask for a lease
  dds_qset_liveliness(qos, DDS_LIVELINESS_AUTOMATIC, DDS_SECS(1));
  const dds_entity_t writer = dds_create_writer(domain->participant(), topic, qos, nullptr);
  dds_delete_qos(qos);
  ASSERT_GT(writer, 0);
  Lights lights;
  lights.lights[1].direction[0] = kNan;
  ASSERT_EQ(dds_write(writer, &lights.frame), DDS_RETCODE_OK);
  LightFrame message;
  EXPECT_FALSE(reader->take(message, std::chrono::milliseconds(0)));
  EXPECT_EQ(reader->refused(), 1u);
  EXPECT_EQ(reader->refusal(), "light 1: direction is not unit");
  lights.lights[1].direction[0] = 1;
  ASSERT_EQ(dds_write(writer, &lights.frame), DDS_RETCODE_OK);
  EXPECT_TRUE(reader->take(message, std::chrono::seconds(20)));
  dds_delete(writer);
  dds_delete(topic);
}

}  // namespace
}  // namespace lightwell
