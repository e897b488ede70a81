// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Scenes and lights that are wrong, or right and unusual: one clear line or a clear picture, never a crash, never black
// without a word.
#include <gtest/gtest.h>

#include <GLES3/gl31.h>

#include <algorithm>
#include <cmath>

#include "interface/atomic_file.h"
#include "interface/environment_io.h"
#include "interface/light_set_io.h"
#include "render/egl_context.h"
#include "tests/integration/render/program.h"
#include "tests/support/gltf_document.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_scene.h"

namespace lightwell {
namespace {

using nlohmann::json;
using test::ChildProcess;
using test::Document;
using test::start_render;

class BadInput : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto context = render::EglContext::create();
    if (!context) GTEST_SKIP() << context.error().message;
    write_lights(test::light_set({{Vec3f(0.3f, 1, 0.5f), Rgb::Constant(1000)}}));
  }

  // A leaning triangle over a larger one.
  static Document scene() {
    Document d;
    json& attributes = d.primitive()["attributes"];
    attributes["POSITION"] = d.add<float>(
        {-0.5f, 0.3f, 0.2f, 0.5f, 0.3f, 0.2f, 0, 0.9f, -0.2f, -2, 0, 2, 2, 0, 2, 0, 0, -2}, "VEC3", 5126, 3);
    attributes["NORMAL"] = d.add<float>(
        {0, 0.6f, 0.8f, 0, 0.6f, 0.8f, 0, 0.6f, 0.8f, 0, 1, 0, 0, 1, 0, 0, 1, 0}, "VEC3", 5126, 3);
    return d;
  }

  struct Outcome {
    int exit_code = 0;
    std::string errors;
    LatLongImage picture;  // empty: none was written
    [[nodiscard]] bool says(const std::string& words) const {
      return errors.find(words) != std::string::npos;
    }
    [[nodiscard]] float brightest() const {
      float most = 0;
      for (const Rgb& c : picture.pixels) most = std::max(most, c.maxCoeff());
      return most;
    }
  };
  Outcome render(const std::string& gltf, const std::vector<std::string>& more = {},
                 const std::vector<std::string>& environment = {}) {
    EXPECT_TRUE(write_file_atomically(folder_.path() / "scene.gltf", gltf));
    const std::string picture = file("picture.exr");
    std::filesystem::remove(picture);
    std::vector<std::string> words = {"--scene",     file("scene.gltf"),
                                      "--light-set", file("lights.json"),
                                      "--headless",  "--size",
                                      "48x36",       "--shadow-size",
                                      "64",          "--out",
                                      picture};
    words.insert(words.end(), more.begin(), more.end());
    ChildProcess program = start_render(folder_.path(), words, environment);
    Outcome outcome;
    outcome.exit_code = program.wait();
    outcome.errors = program.stderr_text();
    if (std::filesystem::exists(picture)) {
      auto read = read_environment(picture);
      EXPECT_TRUE(read.ok());
      if (read) outcome.picture = std::move(read->image);
    }
    return outcome;
  }
  void write_lights(const LightSet& lights) { ASSERT_TRUE(write_light_set(file("lights.json"), lights)); }
  static void expect_refused(const Outcome& outcome, int exit_code, const std::string& named) {
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.errors;
    EXPECT_TRUE(outcome.says(named)) << outcome.errors;
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
    EXPECT_TRUE(outcome.picture.pixels.empty());
  }
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_.path() / name).string(); }

  test::TemporaryFolder folder_;
};

TEST_F(BadInput, ALostContextIsOneLineAndNoPictureOfItIsWritten) {
  GLint extensions = 0;
  {
    const auto context = render::EglContext::create();
    glGetIntegerv(GL_NUM_EXTENSIONS, &extensions);
    bool tells = false;
    for (GLuint i = 0; i < static_cast<GLuint>(extensions); ++i) {
      const std::string name = reinterpret_cast<const char*>(glGetStringi(GL_EXTENSIONS, i));
      tells = tells || name == "GL_EXT_robustness" || name == "GL_KHR_robustness";
    }
    if (!tells) GTEST_SKIP() << "this driver cannot tell that a context is lost";
  }
  // Built without sanitizers, whose library wants to be the first otherwise.
  const Outcome o = render(
      scene().text(), {"--frames", "5", "--out", file("f_%d.exr")},
      {"LD_PRELOAD=" LIGHTWELL_LOST_CONTEXT, "LIGHTWELL_FRAMES=2", "ASAN_OPTIONS=verify_asan_link_order=0"});
  EXPECT_EQ(o.exit_code, 1);
  const std::string line =
      "lightwell-render: the OpenGL ES context is lost: another program made the graphics driver reset";
  EXPECT_TRUE(o.says(line)) << o.errors;
  EXPECT_EQ(o.errors.find('\n', o.errors.find(line)), o.errors.size() - 1) << "nothing comes after it";
  EXPECT_TRUE(o.picture.pixels.empty());
  EXPECT_TRUE(std::filesystem::exists(file("f_1.exr")));
  EXPECT_FALSE(std::filesystem::exists(file("f_2.exr")));
}

TEST_F(BadInput, WithoutACameraOneThatSeesTheSceneIsUsedAndSaid) {
  const Outcome o = render(scene().text());
  EXPECT_EQ(o.exit_code, 0);
  EXPECT_TRUE(o.says("no perspective camera")) << o.errors;
  EXPECT_GT(o.brightest(), 100);
}

TEST_F(BadInput, ObjectsTooFarApartForTheirShadowsAreSaid) {
  Document d = scene();
  d.root["nodes"].push_back({{"mesh", 0}, {"translation", {1e5, 0, 0}}});
  d.root["scenes"][0]["nodes"] = {0, 1};
  const Outcome o = render(d.text());
  EXPECT_EQ(o.exit_code, 0);
  EXPECT_TRUE(o.says("2 of 2 objects are smaller than the finest texel")) << o.errors;
  EXPECT_FALSE(render(scene().text()).says("texel"));
  // A large thing with small parts has shadows that are seen.
  Document parts = scene();
  parts.root["nodes"][0]["scale"] = {1000, 1000, 1000};
  parts.root["nodes"].push_back({{"mesh", 0}, {"translation", {3, 0, 0}}});
  parts.root["scenes"][0]["nodes"] = {0, 1};
  EXPECT_FALSE(render(parts.text()).says("texel"));
}

TEST_F(BadInput, AnyScaleGivesTheSamePicture) {
  const Outcome unit = render(scene().text());
  ASSERT_EQ(unit.picture.pixels.size(), 48u * 36u);
  for (const double scale : {1e-6, 1e6}) {
    Document d = scene();
    d.root["nodes"][0]["scale"] = {scale, scale, scale};
    const Outcome o = render(d.text());
    ASSERT_EQ(o.picture.pixels.size(), unit.picture.pixels.size()) << o.errors;
    int differ = 0;
    for (std::size_t i = 0; i < o.picture.pixels.size(); ++i)
      if ((o.picture.pixels[i] - unit.picture.pixels[i]).abs().maxCoeff() > 1e-3f * unit.brightest())
        ++differ;
    // Rounding may move an outline over a pixel's centre: of triangles and shadow, about 100 pixels.
    EXPECT_LE(differ, 3) << scale;
  }
}

TEST_F(BadInput, MissingBuffersAndPicturesAreNamed) {
  Document d = scene();
  d.text();
  d.root["buffers"][0]["uri"] = "gone.bin";
  expect_refused(render(d.root.dump()), 3, "gone.bin");
  Document e = scene();
  e.root["images"] = json::array({{{"uri", "gone.png"}}});
  e.root["textures"] = json::array({{{"source", 0}}});
  expect_refused(render(e.text()), 3, "gone.png");
}

TEST_F(BadInput, NormalsAndPositionsThatAreNoNumbersAreNamed) {
  for (const char* attribute : {"NORMAL", "POSITION"}) {
    Document d = scene();
    std::vector<float> values(18, 1);
    values[4] = std::nanf("");
    d.primitive()["attributes"][attribute] = d.add<float>(values, "VEC3", 5126, 3);
    expect_refused(render(d.text()), 3,
                   std::string("mesh 0 primitive 0 ") + attribute + ": element 1 is not finite");
  }
}

TEST_F(BadInput, TrianglesOfNoAreaAreSaidAndNormalsOfNoLengthAreTheTriangles) {
  Document d = scene();
  d.primitive()["attributes"]["NORMAL"] = d.add<float>(std::vector<float>(18, 0), "VEC3", 5126, 3);
  d.primitive()["indices"] = d.add<std::uint8_t>({0, 1, 2, 3, 4, 5, 1, 1, 2}, "SCALAR", 5121, 1);
  const Outcome o = render(d.text());
  EXPECT_EQ(o.exit_code, 0) << o.errors;
  EXPECT_TRUE(o.says("1 triangles of no area left out")) << o.errors;
  EXPECT_GT(o.brightest(), 100);
  for (const Rgb& c : o.picture.pixels) EXPECT_TRUE(c.isFinite().all());
  Document none = scene();
  none.primitive()["indices"] = none.add<std::uint8_t>({1, 1, 2}, "SCALAR", 5121, 1);
  expect_refused(render(none.text()), 3, "no triangles with an area");
}

TEST_F(BadInput, WithoutPowerTheAmbientLightIsSeenAndItIsSaid) {
  LightSet lights;
  lights.ambient = Rgb::Constant(20);
  write_lights(lights);
  const Outcome ambient = render(scene().text());
  EXPECT_EQ(ambient.exit_code, 0);
  EXPECT_TRUE(ambient.says("lights.json: no light has power, only its ambient light is seen"))
      << ambient.errors;
  EXPECT_GT(ambient.brightest(), 1);
  write_lights(LightSet());
  const Outcome dark = render(scene().text());
  EXPECT_EQ(dark.exit_code, 0);
  EXPECT_TRUE(dark.says("the picture is black")) << dark.errors;
  EXPECT_EQ(dark.brightest(), 0);
}

// Lights in rings about the zenith, all alike: what they sum to does not depend on how many they are.
TEST_F(BadInput, FiveThousandLightsShowWhatFiftyDo) {
  const auto picture_of = [&](int count) {
    std::vector<std::pair<Vec3f, Rgb>> lights;
    for (int i = 0; i < count; ++i) {
      const float turn = 2 * static_cast<float>(kPi) * static_cast<float>(i) / static_cast<float>(count);
      lights.emplace_back(Vec3f(0.05f * std::sin(turn), 1, 0.05f * std::cos(turn)),
                          Rgb::Constant(1000 / static_cast<float>(count)));
    }
    write_lights(test::light_set(lights));
    return render(scene().text());
  };
  const Outcome few = picture_of(50);
  const Outcome many = picture_of(5000);
  ASSERT_EQ(many.exit_code, 0) << many.errors;
  EXPECT_NEAR(many.brightest(), few.brightest(), 1e-3f * few.brightest());
}

TEST_F(BadInput, LightsThatAreNoNumbersAreNamedWithTheirRange) {
  const auto lights = [&](const std::string& illuminance) {
    ASSERT_TRUE(write_file_atomically(
        file("lights.json"),
        R"({"schema": "lightwell.lights/1", "method": "best", "coverage": "hemisphere", "total_illuminance": [1, 1, 1], "lights": [)"
        R"({"direction": [0, 1, 0], "illuminance": [)" +
            illuminance + R"(, 1, 1]}]})"));
  };
  lights("NaN");
  expect_refused(render(scene().text()), 3, "lights.json: line 1");
  lights("\"nan\"");
  expect_refused(render(scene().text()), 3, "lights.json: lights[0].illuminance[0] = \"nan\": allowed");
  lights("-5");
  expect_refused(render(scene().text()), 3, "lights.json: lights[0].illuminance[0] = -5: allowed 0.0 to");
}

TEST_F(BadInput, ADriverThatIsTooOldIsSaid) {
  // Mesa's drivers say the version that this asks for; another one would render.
  const Outcome o = render(scene().text(), {}, {"MESA_GLES_VERSION_OVERRIDE=3.0"});
  if (o.exit_code == 0) GTEST_SKIP() << "the driver's version cannot be chosen";
  expect_refused(o, 1, "OpenGL ES 3.1");
}

TEST_F(BadInput, AnUnknownAnimationIsWrongUsageAndBadOnesAreNamed) {
  Document d = scene();
  test::animate(d, 0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0}, "VEC3", 3);
  d.root["animations"][0]["name"] = "fall";
  expect_refused(render(d.text(), {"--animation", "rise"}), 2, "the file has 'fall'");
  expect_refused(render(d.text(), {"--scene-rate", "0"}), 2, "--scene-rate");
  d.root["animations"][0]["samplers"][0]["output"] = 0;
  expect_refused(render(d.text()), 3, "animation 0 channel 0: 18 numbers for 2 times");
}

TEST_F(BadInput, AnAnimatedSceneMovesFrameByFrameAtItsRate) {
  Document d = scene();
  test::animate(d, 0, "translation", {0, 2}, {0, 0, 0, 2, 0, 0}, "VEC3", 3);
  d.root["cameras"] =
      json::array({{{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}}});
  d.root["nodes"].push_back({{"camera", 0}, {"translation", {0, 1, 6}}});
  d.root["scenes"][0]["nodes"] = {0, 1};
  // Frame 5 at 10 Hz stands where a scene moved by 0.5 does; frame 20 is the first again.
  const Outcome half = render(d.text(), {"--frames", "6", "--scene-rate", "10"});
  const Outcome again = render(d.text(), {"--frames", "21", "--scene-rate", "10"});
  d.root.erase("animations");
  const Outcome begin = render(d.text());
  d.root["nodes"][0]["translation"] = {0.5, 0, 0};
  const Outcome there = render(d.text());
  ASSERT_EQ(half.picture.pixels.size(), there.picture.pixels.size()) << half.errors;
  ASSERT_EQ(again.picture.pixels.size(), begin.picture.pixels.size()) << again.errors;
  const auto differ = [](const Outcome& a, const Outcome& b) {
    int count = 0;
    for (std::size_t i = 0; i < a.picture.pixels.size(); ++i)
      if ((a.picture.pixels[i] != b.picture.pixels[i]).any()) ++count;
    return count;
  };
  EXPECT_EQ(differ(half, there), 0);
  EXPECT_EQ(differ(again, begin), 0);
  EXPECT_GT(differ(half, begin), 10);
}

}  // namespace
}  // namespace lightwell
