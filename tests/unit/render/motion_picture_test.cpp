// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "interface/atomic_file.h"
#include "render/gltf_scene.h"
#include "render/scene_motion.h"
#include "tests/support/gltf_document.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/render/render_fixture.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

// A ball, and a floor that casts.
Document ball_on_floor(const std::vector<float>& place) {
  Document d;
  Scene ball;
  add_sphere(ball, Vec3f::Zero(), 0.5f, lambertian(Rgb::Ones()), true, 12);
  std::vector<float> positions;
  std::vector<float> normals;
  for (const auto i : ball.indices) {
    positions.insert(positions.end(), ball.vertices[i].position.begin(), ball.vertices[i].position.end());
    normals.insert(normals.end(), ball.vertices[i].normal.begin(), ball.vertices[i].normal.end());
  }
  d.primitive()["attributes"]["POSITION"] = d.add<float>(positions, "VEC3", 5126, 3);
  d.primitive()["attributes"]["NORMAL"] = d.add<float>(normals, "VEC3", 5126, 3);
  const int floor =
      d.add<float>({-4, 0, -4, -4, 0, 4, 4, 0, 4, -4, 0, -4, 4, 0, 4, 4, 0, -4}, "VEC3", 5126, 3);
  d.root["meshes"].push_back({{"primitives", json::array({{{"attributes", {{"POSITION", floor}}}}})}});
  d.root["nodes"] = json::array({{{"mesh", 0}, {"translation", place}},
                                 {{"mesh", 1}},
                                 {{"mesh", 0}, {"translation", {-1.5f, 0.5f, -1}}}});
  d.root["scenes"][0]["nodes"] = {0, 1, 2};
  return d;
}

Result<Scene> read(Document d) {
  const TemporaryFolder folder;
  EXPECT_TRUE(write_file_atomically(folder.path() / "scene.gltf", d.text()));
  return render::read_gltf(folder.path() / "scene.gltf");
}

class MovingPictures : public Rendering {};

TEST_F(MovingPictures, ABallThatMovedLooksLikeABallThatStandsThere) {
  // Numbers that single precision holds, so that both come to the same place exactly.
  Document moving = ball_on_floor({0, 0.5f, 0});
  animate(moving, 0, "translation", {0, 1, 2}, {0, 0.5f, 0, 1, 1, 0.5f, 2, 2, 0.5f}, "VEC3", 3);
  auto scene = read(moving);
  auto there = read(ball_on_floor({0.5f, 0.75f, 0.25f}));
  ASSERT_TRUE(scene.ok() && there.ok());
  const LightSet lights = light_set({{Vec3f(1, 2, 1), Rgb::Constant(1000)},
                                     {Vec3f(-1, 1, 0), Rgb(100, 200, 300)},
                                     {Vec3f(0.2f, -1, 0), Rgb::Ones()}});
  const SceneCamera camera = camera_at({0, 3, 6}, {0, 0.5f, 0});
  // Simpler meshes are not the same at other places: that is a matter of a quarter of a texel.
  for (const bool simplify : {false, true}) {
    render::RendererOptions options;
    options.width = 80;
    options.height = 60;
    options.simplify_casters = simplify;
    auto renderer = render::Renderer::create(*scene, options);
    ASSERT_TRUE(renderer.ok()) << renderer.error().message;
    render::SceneMotion motion(*scene);
    for (const double time_s : {0.1, 1.4, 0.5}) {
      ASSERT_TRUE(motion.move_to(time_s));
      renderer->move(*scene, motion.moved());
      ASSERT_TRUE(renderer->render(lights, camera));
    }
    const auto moved = renderer->radiance();
    const auto expected = picture(*there, lights, camera, 80, 60, 1, 256, simplify);
    int differ = 0;
    for (std::size_t i = 0; i < expected.rgba.size(); ++i)
      if (moved.rgba[i] != expected.rgba[i]) ++differ;
    // Along the outline of the shadows, at most: two balls, three lights, about 40 pixels around each, four channels.
    EXPECT_LE(differ, simplify ? 2 * 3 * 40 * 4 / 4 : 0);
    ASSERT_TRUE(motion.move_to(0));
  }
}

// A ball that creeps: its shadow follows by steps of a quarter of the finest map's texel, and no step is seen.
TEST_F(MovingPictures, ShadowsOfWhatCreepsFollowInStepsTooSmallToSee) {
  Document moving = ball_on_floor({0, 0.5f, 0});
  animate(moving, 0, "translation", {0, 1}, {0, 0.5f, 0, 0.1f, 0.5f, 0.05f}, "VEC3", 3);
  auto scene = read(moving);
  ASSERT_TRUE(scene.ok());
  const LightSet lights = light_set({{Vec3f(1, 2, 1), Rgb::Constant(1000)},
                                     {Vec3f(-1, 1, 0), Rgb(100, 200, 300)},
                                     {Vec3f(0.9f, 0.3f, -0.2f), Rgb::Constant(200)}});
  const SceneCamera camera = camera_at({0, 3, 6}, {0, 0.5f, 0});
  render::RendererOptions options;
  options.width = 160;
  options.height = 120;
  options.shadow_size = 128;
  auto creeping = render::Renderer::create(*scene, options);
  ASSERT_TRUE(creeping.ok()) << creeping.error().message;
  render::SceneMotion motion(*scene);
  int frames_drawn = 0;
  constexpr int kFrames = 50;
  for (int frame = 0; frame < kFrames; ++frame) {
    ASSERT_TRUE(motion.move_to(0.01 * frame));
    creeping->move(*scene, motion.moved());
    ASSERT_TRUE(creeping->render(lights, camera));
    const std::size_t drawn = creeping->shadow_maps_drawn();
    EXPECT_TRUE(drawn == 0 || drawn == 3) << drawn;
    frames_drawn += drawn > 0 ? 1 : 0;
    if (frame % 7 != 3) continue;
    auto anew = render::Renderer::create(*scene, options);
    ASSERT_TRUE(anew.ok());
    anew->move(*scene, std::vector<std::size_t>{0});
    ASSERT_TRUE(anew->render(lights, camera));
    const auto shown = creeping->radiance(), exact = anew->radiance();
    double off = 0, of = 0;
    for (std::size_t i = 0; i < exact.rgba.size(); ++i) {
      off += std::pow(static_cast<double>(shown.rgba[i] - exact.rgba[i]), 2);
      of += std::pow(static_cast<double>(exact.rgba[i]), 2);
    }
    // A quarter of a texel along every outline.
    EXPECT_LE(std::sqrt(off / of), 0.02) << frame;
  }
  EXPECT_GE(frames_drawn, 3);
  EXPECT_LE(frames_drawn, kFrames / 2);
  ASSERT_TRUE(motion.move_to(0));
}

}  // namespace
}  // namespace lightwell
