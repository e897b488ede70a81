// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "interface/atomic_file.h"
#include "interface/calibration_io.h"
#include "interface/exr_file.h"
#include "tests/integration/commands/command_fixture.h"
#include "tests/support/simulated_rig.h"

namespace lightwell::test {
namespace {

using testing::HasSubstr;

// A small lamp on a rig: a camera without distortion sees the screen askew, one slide after the other, the lamp moves.
class LuminaireBuildTest : public CommandTest {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(path("rig"));
    const LampAxis axis{0, 0.12, 0, 0.5, 0.4};
    rig_ = simulated_rig({0.1, {{Rgbd(1e6, 8e5, 5e5), {axis, axis}}}}, 9, 40);
    rig_.rig.low_m = Vec2d::Constant(-0.18);
    rig_.rig.high_m = -rig_.rig.low_m;
    rig_.rig.moves = Rig::Moves::lamp;
    rig_.rig.unit = Rig::Unit::luminance;
    rig_.rig.screen_reflectance = 0.9;
    rig_.rig.peak_transmission = 0.7;
    rig_.ambient_lux = 2;
    rig_.picture_size = {130, 130};
    Calibration camera;
    camera.response.model = LinearResponse{0, 1};
    camera.lens = {rig_.picture_size, {70, 70}, {64.5, 64.5}, {0.01, 0, 0, 0}, 1.4, Vec3d::UnitZ()};
    rig_.camera = camera;
    rig_.list_pictures();
    ASSERT_TRUE(write_calibration(path("rig/camera"), camera));
    std::ofstream list(path("rig/positions.csv"));
    list << "file,x,y,part\n";
    for (const Rig::Picture& p : rig_.rig.pictures) {
      write_picture(p.file);
      list << p.file << "," << -p.position_m.x() << "," << -p.position_m.y() << ","
           << (p.part == Rig::Part::positive ? "positive" : "negative") << "\n";
    }
    write_picture("dark.exr");
    write_rig(description());
  }
  void write_picture(const std::string& file) {
    const LatLongImage image = rig_.picture(file);
    const auto bytes = exr_from_floats(
        image.width, image.height, "RGB",
        {reinterpret_cast<const float*>(image.pixels.data()), image.pixels.size() * 3}, ExrContent::picture);
    ASSERT_TRUE(bytes) << bytes.error().message;
    ASSERT_TRUE(write_file_atomically(path("rig/" + file), *bytes));
  }
  [[nodiscard]] std::string description() const {
    std::string text = R"(schema = "lightwell.rig/1"
name = "Torch"
[sampling]
spacing_m = 0.01
filter = "finite"
peak_transmission = 0.7
moves = "lamp"
[measurement]
distance_m = 0.1
low_m = [-0.18, -0.18]
high_m = [0.18, 0.18]
pixels = [40, 40]
[camera]
unit = "cd/m2"
calibration = "camera"
screen_reflectance = 0.9
dark = "dark.exr"
)";
    char mark[200];
    for (const Rig::Mark& m : rig_.rig.marks) {
      std::snprintf(mark, sizeof mark, "[[marks]]\npixel = [%.6f, %.6f]\nscreen_m = [%.6f, %.6f]\n",
                    m.pixel.x(), m.pixel.y(), m.screen_m.x(), m.screen_m.y());
      text += mark;
    }
    return text;
  }
  void write_rig(const std::string& text) const { std::ofstream(path("rig/rig.toml")) << text; }
  [[nodiscard]] ProcessResult build(const std::string& out = "lamp.exr") const {
    return lightwell({"luminaire", "build", path("rig"), "--out", path(out), "--json"});
  }
  void expect_refused(const ProcessResult& result, int code, const std::string& text) const {
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_THAT(result.err, HasSubstr(text));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(path("lamp.exr")));
  }
  SimulatedRig rig_;
};

// A camera's pixel is 6 mm wide on the screen, the lamp's lobe 4 cm.
TEST_F(LuminaireBuildTest, ARigsFolderBecomesALampThatAnswers) {
  const auto built = build();
  ASSERT_EQ(built.exit_code, 0) << built.err;
  EXPECT_EQ(built.err, "");
  const auto report = nlohmann::json::parse(built.out);
  EXPECT_EQ(report["schema"], "lightwell.luminaire-build/1");
  EXPECT_EQ(report["name"], "Torch");
  EXPECT_EQ(report["positions"], nlohmann::json({9, 9}));
  EXPECT_LT(report["mark_rms_px"].get<double>(), 1e-3);
  std::ofstream points(path("p.csv"));
  points << "x,y,z,u,v,w\n";
  std::vector<Rgbd> truth;
  for (const double distance : {0.2, 0.4, 1.0, 4.0})
    for (const double x : {0.0, 0.2, -0.3}) {
      const Vec3d at = Vec3d(x, 0.1, -distance) * 0.1, normal = Vec3d(0.2, -0.1, 1).normalized();
      points << at.x() << "," << at.y() << "," << at.z() << ",0.2,-0.1,1\n";
      truth.push_back(rig_.lamp.illuminance(at, normal));
    }
  points.close();
  const auto asked = lightwell({"luminaire", "query", path("lamp.exr"), "--points", path("p.csv"), "--json"});
  ASSERT_EQ(asked.exit_code, 0) << asked.err;
  const auto lux = nlohmann::json::parse(asked.out)["illuminance"];
  ASSERT_EQ(lux.size(), truth.size());
  for (std::size_t plane = 0; plane < truth.size(); plane += 3) {
    double error = 0, norm = 0;
    for (std::size_t i = plane; i < plane + 3; ++i)
      for (int c = 0; c < 3; ++c) {
        error += std::pow(lux[i][static_cast<std::size_t>(c)].get<double>() - truth[i][c], 2);
        norm += truth[i][c] * truth[i][c];
      }
    EXPECT_LT(std::sqrt(error / norm), 0.02) << "plane " << plane / 3;
  }
}

TEST_F(LuminaireBuildTest, BadRigsAreOneLineAndLeaveNothing) {
  const std::string good = description();
  const auto with = [&](const std::string& old, const std::string& now) {
    std::string text = good;
    text.replace(text.find(old), old.size(), now);
    write_rig(text);
    return build();
  };
  expect_refused(with("[measurement]", "[measure]"), 3, "measurement is missing");
  expect_refused(with("\"dark.exr\"", "\"night.exr\""), 3, "night.exr");
  expect_refused(with("\"camera\"", "\"lens\""), 3, "lens.json");
  expect_refused(with("[camera]", "[camera]\nsaturation = 1"), 3,
                 "are saturated, allowed: most_saturated, 0.0001");
  expect_refused(with("high_m = [0.18, 0.18]", "high_m = [1, 0.18]"), 3,
                 "of the measurement plane, allowed: 100 %");
  write_rig(good);
  const auto over = build("rig/4_4p.exr");
  EXPECT_EQ(over.exit_code, 2) << over.err;
  std::ofstream(path("rig/3_3n.exr")) << "no picture";
  expect_refused(build(), 3, "3_3n.exr");
  std::filesystem::remove(path("rig/positions.csv"));
  expect_refused(build(), 3, "positions.csv");
  expect_refused(lightwell({"luminaire", "build", path("nowhere"), "--out", path("lamp.exr")}), 3,
                 "rig.toml");
}

}  // namespace
}  // namespace lightwell::test
