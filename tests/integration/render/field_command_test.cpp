// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "interface/atomic_file.h"
#include "interface/environment_io.h"
#include "interface/field_file.h"
#include "interface/light_set_io.h"
#include "render/egl_context.h"
#include "tests/integration/render/fake_field.h"
#include "tests/integration/render/program.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_scene.h"

namespace lightwell {
namespace {

using test::ChildProcess;
using test::stage_field;
using test::start_render;

class FieldCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto context = render::EglContext::create();
    if (!context) GTEST_SKIP() << context.error().message;
    ASSERT_TRUE(write_field(field_, stage_field(1), {}));
  }
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_.path() / name).string(); }
  std::vector<std::string> arguments(std::vector<std::string> more) const {
    std::vector<std::string> all = {"--scene", LIGHTWELL_STAGE, "--field",       field_, "--headless",
                                    "--size",  "32x24",         "--shadow-size", "64"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  void expect_refused(const std::vector<std::string>& words, int exit_code, const std::string& named) {
    ChildProcess program = start_render(folder_.path(), words);
    EXPECT_EQ(program.wait(), exit_code) << named;
    const std::string errors = program.stderr_text();
    EXPECT_NE(errors.find(named), std::string::npos) << errors;
    EXPECT_EQ(std::count(errors.begin(), errors.end(), '\n'), 1) << errors;
  }
  nlohmann::json stats() { return nlohmann::json::parse(read_text_file(file("stats.json")).value()); }

  test::TemporaryFolder folder_;
  std::string field_ = (folder_.path() / "field.vdb").string();
};

// Under even light of radiance 1 a matt surface returns its albedo: the stage's ground is one of .42.
TEST_F(FieldCommand, EvenLightReturnsAlbedoAndStatisticsTellOfTheField) {
  ChildProcess program = start_render(
      folder_.path(), arguments({"--frames", "2", "--out", file("a.exr"), "--stats", file("stats.json")}));
  ASSERT_EQ(program.wait(), 0) << program.stderr_text();
  EXPECT_NE(program.stderr_text().find("the light at its border is taken"), std::string::npos)
      << program.stderr_text();
  const auto picture = read_environment(file("a.exr"));
  ASSERT_TRUE(picture.ok());
  EXPECT_NEAR(picture->image.at(16, 23)[0], 0.42f, 0.42e-3f);
  const auto s = stats();
  EXPECT_EQ(s["frames"], 2);
  EXPECT_EQ(s["lights"], 0);
  EXPECT_EQ(s["field"]["size"], (std::vector<int>{3, 2, 3}));
  EXPECT_EQ(s["field"]["degree"], 2);
  EXPECT_EQ(s["field"]["main_lights"], 0);
  EXPECT_LE(s["field"]["texture_units"], 16);
  EXPECT_EQ(s["field"]["bytes"], 7 * 18 * 8);  // nine harmonics of three numbers in texels of four
  for (const char* pass : {"gbuffer", "shading", "tonemap"}) EXPECT_GT(s["passes"][pass], 0);
}

// Under even light every ball is as bright as the light, on the ground that returns .42 of it.
TEST_F(FieldCommand, BallsStandAtGridPointsAndShowTheLight) {
  for (const char* look : {"matt", "mirror"})
    for (const char* count : {"all", "2"}) {
      ChildProcess program =
          start_render(folder_.path(), {"--scene", LIGHTWELL_STAGE, "--field", field_, "--headless", "--size",
                                        "160x120", "--field-balls", count, "--field-ball-look", look, "--out",
                                        file("balls.exr"), "--stats", file("stats.json")});
      ASSERT_EQ(program.wait(), 0) << program.stderr_text();
      EXPECT_EQ(stats()["field"]["balls"], *count == 'a' ? 18 : 8);
      const auto picture = read_environment(file("balls.exr"));
      ASSERT_TRUE(picture.ok());
      int bright = 0;
      for (const Rgb& c : picture->image.pixels) bright += std::abs(c[0] - 1) < 2e-3f;
      EXPECT_GT(bright, 20) << look << " " << count;
    }
}

TEST_F(FieldCommand, MainLightsCastShadowsAsManyAsAreAskedFor) {
  ASSERT_TRUE(write_field(field_, stage_field(1, 20), {}));
  for (const char* count : {"0", "3"}) {
    ChildProcess program =
        start_render(folder_.path(), arguments({"--field-shadows", count, "--stats", file("stats.json")}));
    ASSERT_EQ(program.wait(), 0) << program.stderr_text();
    EXPECT_EQ(stats()["shadow_maps"], *count == '0' ? 0 : 1);
    EXPECT_EQ(stats()["field"]["main_lights"], *count == '0' ? 0 : 1);
  }
}

// A graded plate counts as exposed for a white floor where the objects are.
TEST_F(FieldCommand, APlateLiesBehindAndIsMeteredByTheField) {
  ASSERT_TRUE(write_file_atomically(file("lights.json"), "{}"));
  ChildProcess made = start_render(folder_.path(), arguments({"--out", file("plate.png")}));
  ASSERT_EQ(made.wait(), 0) << made.stderr_text();
  ChildProcess program =
      start_render(folder_.path(), arguments({"--background", file("plate.png"), "--out", file("b.png")}));
  EXPECT_EQ(program.wait(), 0) << program.stderr_text();
  EXPECT_NE(program.stderr_text().find("counts as 1 cd"), std::string::npos) << program.stderr_text();
}

TEST_F(FieldCommand, OtherLightAndWhatGoesWithItIsRefused) {
  expect_refused(arguments({"--live"}), 2, "--live");
  expect_refused(arguments({"--light-set", "a.json"}), 2, "--light-set");
  expect_refused(arguments({"--environment", "a.exr"}), 2, "--environment");
  expect_refused(arguments({"--probe"}), 2, "--probe");
  expect_refused(arguments({"--target-fps", "5"}), 2, "--target-fps");
  expect_refused(arguments({"--max-error", "0.1"}), 2, "--max-error");
  expect_refused(arguments({"--shadow-maps", "3"}), 2, "--shadow-maps");
  expect_refused(arguments({"--background", "environment"}), 2, "--background");
  expect_refused(arguments({"--field-shadows", "9"}), 2, "--field-shadows");
  expect_refused(arguments({"--out", field_ + ".exr", "--stats", field_}), 2, "is also the input");
  expect_refused(arguments({"--field-balls", "1"}), 2, "--field-balls");
  expect_refused(arguments({"--field-balls", "many"}), 2, "--field-balls");
  expect_refused(arguments({"--field-ball-look", "mirror"}), 2, "--field-balls");
  expect_refused({"--scene", LIGHTWELL_STAGE, "--environment", "a.exr", "--field-shadows", "1"}, 2,
                 "--field");
}

TEST_F(FieldCommand, AFileThatIsNoFieldIsBadInput) {
  const auto with = [&](const std::string& name) {
    return std::vector<std::string>{"--scene", LIGHTWELL_STAGE, "--field", name, "--headless"};
  };
  expect_refused(with(file("none.vdb")), 3, "none.vdb");
  ASSERT_TRUE(write_file_atomically(file("text.vdb"), "no field"));
  expect_refused(with(file("text.vdb")), 3, "text.vdb");
  const std::string whole = read_text_file(field_).value();
  ASSERT_TRUE(write_file_atomically(file("cut.vdb"), whole.substr(0, whole.size() / 2)));
  expect_refused(with(file("cut.vdb")), 3, "cut.vdb");
  // A scene of the light's file's name is a mistake that is said as such.
  expect_refused({"--scene", field_, "--field", field_, "--headless"}, 3, "field.vdb");
}

}  // namespace
}  // namespace lightwell
