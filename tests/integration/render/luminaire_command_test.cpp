// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// lightwell-render --luminaire as a program.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "interface/atomic_file.h"
#include "interface/environment_io.h"
#include "interface/luminaire_file.h"
#include "render/egl_context.h"
#include "tests/integration/render/program.h"
#include "tests/support/gltf_document.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

using test::ChildProcess;
using test::start_render;

constexpr float kAlbedo = 0.5f;
constexpr double kCandela = 200;

class LuminaireCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto context = render::EglContext::create();
    if (!context) GTEST_SKIP() << context.error().message;
    Luminaire even;
    even.far.emplace();
    even.far->vertical_deg = {0, 180};
    even.far->candela = {kCandela, kCandela};
    ASSERT_TRUE(write_luminaire(lamp_, even));
    // A matt triangle that faces +Z, and a node that goes from one metre before it to two within a second.
    test::Document scene = test::triangle();
    const std::vector<float> colour(3, kAlbedo);
    scene.root["materials"] = nlohmann::json::array(
        {{{"extras", {{"phong", {{"diffuse", colour}, {"specular", {0, 0, 0}}, {"exponent", 1}}}}}}});
    scene.primitive()["material"] = 0;
    scene.root["nodes"].push_back({{"name", "carrier"}, {"translation", {0.25, 0.25, 1}}});
    // One name twice, the second scaled to nothing, as is the only one of its name.
    scene.root["nodes"].push_back({{"name", "twin"}, {"translation", {0.25, 0.25, 1}}});
    scene.root["nodes"].push_back({{"name", "twin"}, {"scale", {0, 0, 0}}});
    scene.root["nodes"].push_back({{"name", "nothing"}, {"scale", {0, 0, 0}}});
    for (const int node : {1, 2, 3, 4}) scene.root["scenes"][0]["nodes"].push_back(node);
    test::animate(scene, 1, "translation", {0, 1}, {0.25f, 0.25f, 1, 0.25f, 0.25f, 2}, "VEC3", 3);
    std::ofstream(scene_) << scene.text();
  }
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_.path() / name).string(); }
  std::vector<std::string> arguments(std::vector<std::string> more) const {
    std::vector<std::string> all = {"--scene", scene_,          "--headless", "--size",
                                    "64x64",   "--shadow-size", "64"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  void expect_refused(const std::vector<std::string>& more, int exit_code, const std::string& named) {
    ChildProcess program = start_render(folder_.path(), arguments(more));
    EXPECT_EQ(program.wait(), exit_code) << named;
    const std::string errors = program.stderr_text();
    EXPECT_NE(errors.find(named), std::string::npos) << errors;
    EXPECT_EQ(std::count(errors.begin(), errors.end(), '\n'), 1) << errors;
  }
  // The brightest pixel of a picture: the foot of the lamp, at a metre kAlbedo / π · candela.
  [[nodiscard]] float brightest(const std::string& name) const {
    const auto picture = read_environment(file(name));
    EXPECT_TRUE(picture.ok());
    float most = 0;
    for (const Rgb& pixel : picture->image.pixels) most = std::max(most, pixel[1]);
    return most;
  }

  test::TemporaryFolder folder_;
  std::string lamp_ = (folder_.path() / "lamp.exr").string();
  std::string scene_ = (folder_.path() / "scene.gltf").string();
};

TEST_F(LuminaireCommand, InverseSquareAndScaleAreExactAndStatisticsTellOfTheLamps) {
  const float at_a_metre = kAlbedo * static_cast<float>(kCandela / kPi);
  ChildProcess program = start_render(
      folder_.path(),
      arguments({"--luminaire", lamp_, "--luminaire-pose", "0.25,0.25,1", "--luminaire", lamp_,
                 "--luminaire-pose", "0.25,0.25,2,180,0,0", "--luminaire-scale", "1", "--luminaire-scale",
                 "2", "--out", file("a.exr"), "--stats", file("stats.json")}));
  ASSERT_EQ(program.wait(), 0) << program.stderr_text();
  // The nearest pixel's centre is up to 1 cm beside the foot, which is 2e-4.
  EXPECT_NEAR(brightest("a.exr"), at_a_metre * 1.5f, 2e-3f * at_a_metre);
  const auto stats = nlohmann::json::parse(read_text_file(file("stats.json")).value());
  EXPECT_EQ(stats["lights"], 0);
  EXPECT_EQ(stats["luminaires"]["count"], 2);
  EXPECT_EQ(stats["luminaires"]["positions"], 2);
  EXPECT_EQ(stats["luminaires"]["sources"], 2);
}

TEST_F(LuminaireCommand, LampMovesWithTheNodeThatCarriesIt) {
  ChildProcess program =
      start_render(folder_.path(), arguments({"--luminaire", lamp_, "--luminaire-node", "carrier", "--frames",
                                              "2", "--scene-rate", "2", "--out", file("a_%04d.exr")}));
  ASSERT_EQ(program.wait(), 0) << program.stderr_text();
  EXPECT_NEAR(brightest("a_0001.exr") / brightest("a_0000.exr"), 1 / (1.5f * 1.5f), 2e-3f);
}

TEST_F(LuminaireCommand, LampThatLightsNothingIsSaid) {
  ChildProcess program = start_render(folder_.path(), arguments({"--luminaire", lamp_, "--luminaire-scale",
                                                                 "1", "--luminaire-pose", "0.25,0.25,0"}));
  ASSERT_EQ(program.wait(), 0) << program.stderr_text();
  EXPECT_NE(program.stderr_text().find("lights none of the 256 places of the scene"), std::string::npos)
      << program.stderr_text();
}

TEST_F(LuminaireCommand, NodeThatMayNotBeMeantIsSaid) {
  for (const auto& [node, said] : {std::pair("twin", "twin: 2 nodes have the name, the first carries"),
                                   std::pair("nothing", "scaled to 0")}) {
    ChildProcess program =
        start_render(folder_.path(), arguments({"--luminaire", lamp_, "--luminaire-node", node,
                                                "--luminaire-pose", "0,0,1", "--out", file("n.exr")}));
    ASSERT_EQ(program.wait(), 0) << program.stderr_text();
    EXPECT_NE(program.stderr_text().find(said), std::string::npos) << program.stderr_text();
  }
}

TEST_F(LuminaireCommand, BadInputIsRefusedInOneLine) {
  expect_refused({"--luminaire", lamp_, "--luminaire-pose", "1,2"}, 2, "--luminaire-pose 1,2");
  expect_refused({"--luminaire", lamp_, "--luminaire-pose", "1,2,nan"}, 2, "x,y,z,yaw,pitch,roll");
  expect_refused({"--luminaire", lamp_, "--luminaire-pose", "0,0,1,0,0,0,0.5"}, 2, "a unit quaternion");
  expect_refused({"--luminaire", lamp_, "--luminaire-pose", "0,0,1", "--luminaire-pose", "0,0,2"}, 2,
                 "given 2 times for 1 lamp");
  expect_refused({"--luminaire", lamp_, "--luminaire-scale", "-1"}, 2, "0 to 1e6");
  expect_refused({"--luminaire", lamp_, "--luminaire-node", "nobody"}, 2, "nobody");
  expect_refused({"--luminaire", file("missing.exr")}, 3, "missing.exr");
  expect_refused({"--luminaire", lamp_, "--out", lamp_}, 2, "lamp.exr");
  // Cut off, and a picture that is no lamp.
  std::filesystem::copy_file(lamp_, file("cut.exr"));
  std::filesystem::resize_file(file("cut.exr"), std::filesystem::file_size(lamp_) / 2);
  expect_refused({"--luminaire", file("cut.exr")}, 3, "cut.exr");
  std::ofstream(file("text.exr")) << "no lamp";
  expect_refused({"--luminaire", file("text.exr")}, 3, "text.exr");
}

}  // namespace
}  // namespace lightwell
