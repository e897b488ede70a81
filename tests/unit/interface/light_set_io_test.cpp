// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/light_set_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

using test::TemporaryFolder;
using testing::HasSubstr;

LightSet random_set(bool parents) {
  LightSet set;
  set.method = "best";
  set.coverage = Coverage::sphere;
  set.has_parents = parents;
  std::mt19937 generator(3);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> exponent(-40.0f, 30.0f);
  for (int i = 0; i < 500; ++i) {
    DirectionalLight light;
    light.direction = Vec3f(normal(generator), normal(generator), normal(generator)).normalized();
    for (int c = 0; c < 3; ++c) light.illuminance[c] = std::pow(10.0f, exponent(generator));
    light.parent = parents ? i - 1 : -1;
    light.id = static_cast<std::uint32_t>(generator());
    light.angular_radius_rad = 1.0f / static_cast<float>(1 + i);
    set.lights.push_back(light);
  }
  set.total_illuminance = {1.0f / 3, 1e25f, 1e-30f};
  set.ambient = {0.1f, 0.2f, 0.3f};
  return set;
}

TEST(LightSetIo, EveryFloatComesBackBitForBit) {
  const TemporaryFolder folder;
  for (const bool parents : {false, true}) {
    const LightSet set = random_set(parents);
    ASSERT_TRUE(write_light_set(folder.path() / "lights.json", set));
    for (const auto& back : {read_light_set(folder.path() / "lights.json").value(),
                             light_set_from_json(light_set_to_json(set, true), "x").value()}) {
      EXPECT_EQ(back.method, set.method);
      EXPECT_EQ(back.coverage, set.coverage);
      EXPECT_EQ(back.has_parents, parents);
      EXPECT_TRUE((back.total_illuminance == set.total_illuminance).all());
      EXPECT_TRUE((back.ambient == set.ambient).all());
      ASSERT_EQ(back.lights.size(), set.lights.size());
      for (std::size_t i = 0; i < set.lights.size(); ++i) {
        EXPECT_EQ(back.lights[i].direction, set.lights[i].direction);
        EXPECT_TRUE((back.lights[i].illuminance == set.lights[i].illuminance).all());
        EXPECT_EQ(back.lights[i].parent, set.lights[i].parent);
        EXPECT_EQ(back.lights[i].id, set.lights[i].id);
        EXPECT_EQ(back.lights[i].angular_radius_rad, set.lights[i].angular_radius_rad);
      }
    }
  }
}

TEST(LightSetIo, OneLineIsOneLine) {
  const std::string text = light_set_to_json(random_set(true), true);
  EXPECT_EQ(text.find('\n'), text.size() - 1);
}

TEST(LightSetIo, ReadsTheContractsExample) {
  const auto set =
      light_set_from_json(R"({"schema": "lightwell.lights/1", "method": "best", "coverage": "hemisphere",
      "total_illuminance": [1, 2, 3.5], "lights": [{"direction": [0, 1, 0], "illuminance": [1, 2, 3.5]}]})",
                          "x");
  ASSERT_TRUE(set);
  EXPECT_EQ(set->lights.size(), 1u);
  EXPECT_FALSE(set->has_parents);
  EXPECT_TRUE((set->ambient == Rgb::Zero()).all());
}

TEST(LightSetIo, DirectionsThatAreNearlyUnitAreNormalised) {
  const auto set =
      light_set_from_json(R"({"schema":"lightwell.lights/1","coverage":"sphere","total_illuminance":[0,0,0],
      "lights":[{"direction":[0,0.9995,0],"illuminance":[0,0,0]}]})",
                          "x");
  ASSERT_TRUE(set);
  EXPECT_EQ(set->lights[0].direction.y(), 1.0f);
}

TEST(LightSetIo, BadInputIsOneLineThatNamesFileAndField) {
  const std::string head =
      R"({"schema":"lightwell.lights/1","method":"x","coverage":"sphere","total_illuminance":[1,1,1],)";
  const auto light = [&](const std::string& fields) { return head + R"("lights":[{)" + fields + "}]}"; };
  const std::pair<std::string, std::string> cases[] = {
      {"", "JSON"},
      {"{", "JSON"},
      {"[1,2]", "object"},
      {R"({"schema":"lightwell.lights/2"})", "lightwell.lights/2"},
      {"{}", "schema"},
      {head + R"("lights":3})", "lights"},
      {R"({"schema":"lightwell.lights/1","coverage":"cube"})", "coverage"},
      {light(R"("illuminance":[1,1,1])"), "lights[0].direction"},
      {light(R"("direction":[0,1,0])"), "lights[0].illuminance"},
      {light(R"("direction":[0,2,0],"illuminance":[1,1,1])"), "length 2"},
      {light(R"("direction":[0,1],"illuminance":[1,1,1])"), "array of 3 numbers"},
      {light(R"("direction":[0,1,0],"illuminance":[1,-1,1])"), "illuminance[1]"},
      {light(R"("direction":[0,1,0],"illuminance":[1,null,1])"), "illuminance[1]"},
      {light(R"("direction":[0,1,0],"illuminance":[1,1e39,1])"), "1e+39"},
      {light(R"("direction":[0,1,0],"illuminance":[1,NaN,1])"), "JSON"},
      {light(R"("direction":[0,1,0],"illuminance":[1,1,1],"parent":0)"), "lights[0].parent"},
      {light(R"("direction":[0,1,0],"illuminance":[1,1,1],"parent":18446744073709551615)"),
       "lights[0].parent"},
      {light(R"("direction":[0,1,0],"illuminance":[1,1,1],"angular_radius_rad":-1)"),
       "lights[0].angular_radius_rad"},
      {head + R"("lights":[],"ambient":[1]})", "ambient"},
      {R"({"schema":"lightwell.lights/1","coverage":"sphere","lights":[]})", "total_illuminance"},
      {"\xff\xfe", "JSON"},
  };
  for (const auto& [text, names] : cases) {
    const auto set = light_set_from_json(text, "some/lights.json");
    ASSERT_FALSE(set) << text;
    EXPECT_EQ(set.error().kind, ErrorKind::bad_input);
    EXPECT_THAT(set.error().message, HasSubstr("some/lights.json"));
    EXPECT_THAT(set.error().message, HasSubstr(names)) << text;
    EXPECT_EQ(set.error().message.find('\n'), std::string::npos);
  }
}

TEST(LightSetIo, DamagedTextNeverCrashes) {
  const std::string good = light_set_to_json(random_set(true), true).substr(0, 3000);
  std::mt19937 generator(9);
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string text = good;
    for (int k = 0; k < 3; ++k) text[generator() % text.size()] = static_cast<char>(generator());
    refused += light_set_from_json(text, "x").ok() ? 0 : 1;
  }
  EXPECT_EQ(refused, 2000);  // the text is cut: nothing of it is a whole light set
}

}  // namespace
}  // namespace lightwell
