// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// From what probes see of a lamp to its light on an object: `lightwell luminaire locate`, then lightwell-render.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "interface/atomic_file.h"
#include "interface/environment_io.h"
#include "render/egl_context.h"
#include "tests/integration/render/program.h"
#include "tests/support/gltf_document.h"
#include "tests/support/live_stage.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

constexpr double kAlbedo = 0.5;
const test::LampBall kLamp = {{0.3, 1.5, 1.2}, 0.06, Rgbd(400, 300, 200)};

// The brightest place of the scene's matt triangle, (0, 0) (1, 0) (0, 1) facing +Z, under the ball.
Rgbd brightest_truth() {
  double most = 0;
  for (int i = 0; i <= 100; ++i)
    for (int j = 0; i + j <= 100; ++j) {
      const Vec3d toward = kLamp.position - Vec3d(i / 100.0, j / 100.0, 0);
      most = std::max(most, toward.z() / std::pow(toward.norm(), 3));
    }
  return kLamp.intensity * (most * kAlbedo / kPi);
}

TEST(LocatedLamp, LightsAnObjectAsTheLampDoesThatProbesSaw) {
  const auto context = render::EglContext::create();
  if (!context) GTEST_SKIP() << context.error().message;
  const test::TemporaryFolder folder;
  const auto path = [&](const std::string& name) { return (folder.path() / name).string(); };
  const test::StageLight light{[](const Vec3d&, const Vec3d&) { return Rgbd(Rgbd::Constant(5)); }, {kLamp}};
  const std::vector<Vec3d> probes = {{-0.7, 0, 0.5}, {0.8, 0, 0.9}, {0.1, 0.2, 1.5}};
  std::ofstream list(path("probes.csv"));
  list << "x,y,z,file\n";
  for (std::size_t n = 0; n < probes.size(); ++n) {
    const std::string name = "probe_" + std::to_string(n) + ".exr";
    ASSERT_TRUE(write_environment(path(name), lat_long_from_polar_map(test::map_at(light, probes[n]))));
    list << probes[n].x() << "," << probes[n].y() << "," << probes[n].z() << "," << name << "\n";
  }
  list.close();
  test::ChildProcess locate({LIGHTWELL_BIN_DIR "/lightwell", "luminaire", "locate", path("probes.csv"),
                             "--out", path("lamps.json"), "--lamps", path("lamp_%d.exr")},
                            folder.path() / "locate.txt", {});
  ASSERT_EQ(locate.wait(), 0) << locate.stderr_text();
  const auto found = nlohmann::json::parse(read_text_file(path("lamps.json")).value());
  ASSERT_EQ(found["lamps"].size(), 1u);
  // The pose as it stands in the file: position and quaternion.
  std::string pose;
  for (const char* key : {"position", "world_from_lamp"})
    for (const auto& number : found["lamps"][0][key]) pose += (pose.empty() ? "" : ",") + number.dump();
  test::Document scene = test::triangle();
  const std::vector<double> colour(3, kAlbedo);
  scene.root["materials"] = nlohmann::json::array(
      {{{"extras", {{"phong", {{"diffuse", colour}, {"specular", {0, 0, 0}}, {"exponent", 1}}}}}}});
  scene.primitive()["material"] = 0;
  std::ofstream(path("scene.gltf")) << scene.text();
  test::ChildProcess render = test::start_render(
      folder.path(),
      {"--scene", path("scene.gltf"), "--headless", "--size", "64x64", "--shadow-size", "64", "--luminaire",
       found["lamps"][0]["file"].get<std::string>(), "--luminaire-pose", pose, "--out", path("lit.exr")});
  ASSERT_EQ(render.wait(), 0) << render.stderr_text();
  const auto picture = read_environment(path("lit.exr"));
  ASSERT_TRUE(picture);
  Rgb most = Rgb::Zero();
  for (const Rgb& pixel : picture->image.pixels) most = most.max(pixel);
  const Rgbd truth = brightest_truth();
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(static_cast<double>(most[c]) / truth[c], 1, 0.04) << c;
}

}  // namespace
}  // namespace lightwell
