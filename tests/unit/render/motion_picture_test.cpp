// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "interface/atomic_file.h"
#include "render/gltf_scene.h"
#include "render/scene_motion.h"
#include "tests/support/gltf_document.h"
#include "tests/support/lamp_reference.h"
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

TEST_F(MovingPictures, WhatMovesToALampThatRestsIsLitByAsManyPointsAsItNeedsThere) {
  Document moving = ball_on_floor({0, 0.5f, 0});
  animate(moving, 0, "translation", {0, 1}, {0, 0.5f, 0, 0, 7, 0}, "VEC3", 3);
  auto scene = read(moving);
  ASSERT_TRUE(scene.ok());
  const render::PlacedLamp lamps[] = {
      {std::make_shared<const Luminaire>(Luminaire{"", patterned_lamp(9, 7, 0.05, 16), {}}),
       aimed_down({0, 8, 0}), 1}};
  render::RendererOptions options;
  options.width = options.height = 16;
  options.lamp_error = 0.05;
  const SceneCamera camera = camera_at({0, 3, 6}, {0, 0.5f, 0});
  const auto sources_of = [&](render::Renderer& renderer) {
    EXPECT_TRUE(renderer.render({}, camera).ok());
    return renderer.lamps().counts().sources;
  };
  auto renderer = render::Renderer::create(*scene, options);
  ASSERT_TRUE(renderer.ok() && renderer->set_lamps(lamps).ok());
  const std::size_t afar = sources_of(*renderer);
  render::SceneMotion motion(*scene);
  ASSERT_TRUE(motion.move_to(0.999));
  renderer->move(*scene, motion.moved());
  auto fresh = render::Renderer::create(*scene, options);
  ASSERT_TRUE(fresh.ok() && fresh->set_lamps(lamps).ok());
  EXPECT_GT(sources_of(*renderer), afar);
  EXPECT_EQ(sources_of(*renderer), sources_of(*fresh));
}

double relative_rmse(const render::RadiancePicture& shown, const render::RadiancePicture& exact) {
  double off = 0, of = 0;
  for (std::size_t i = 0; i < exact.rgba.size(); ++i) {
    off += std::pow(static_cast<double>(shown.rgba[i] - exact.rgba[i]), 2);
    of += std::pow(static_cast<double>(exact.rgba[i]), 2);
  }
  return std::sqrt(off / of);
}

// A ball that creeps, under lights of very different maps.
class CreepingPictures : public MovingPictures {
 protected:
  void SetUp() override {
    MovingPictures::SetUp();
    Document moving = ball_on_floor({0, 0.5f, 0});
    animate(moving, 0, "translation", {0, 1}, {0, 0.5f, 0, 0.1f, 0.5f, 0.05f}, "VEC3", 3);
    scene_.emplace(read(moving).value());
    motion_.emplace(*scene_);
    options_.width = 160;
    options_.height = 120;
    options_.shadow_size = 128;
    options_.simplify_casters = false;  // what is simplified anew differs by itself
  }
  [[nodiscard]] render::Renderer renderer() const {
    auto made = render::Renderer::create(*scene_, options_);
    EXPECT_TRUE(made.ok());
    return std::move(made).value();
  }
  [[nodiscard]] double off_from_anew(const render::Renderer& shown) const {
    auto anew = renderer();
    EXPECT_TRUE(anew.render(lights_, camera_));
    return relative_rmse(shown.radiance(), anew.radiance());
  }

  std::optional<Scene> scene_;
  std::optional<render::SceneMotion> motion_;
  render::RendererOptions options_;
  LightSet lights_ = light_set({{Vec3f(1, 2, 1), Rgb::Constant(1000)},
                                {Vec3f(-1, 1, 0), Rgb(100, 200, 300)},
                                {Vec3f(0.9f, 0.3f, -0.2f), Rgb::Constant(200)}});
  SceneCamera camera_ = camera_at({0, 3, 6}, {0, 0.5f, 0});
};

TEST_F(CreepingPictures, ShadowsFollowInStepsTooSmallToSee) {
  render::Renderer creeping = renderer();
  std::size_t drawn = 0;
  constexpr int kFrames = 60;
  for (int frame = 0; frame < kFrames; ++frame) {
    ASSERT_TRUE(motion_->move_to(0.01 * frame));
    creeping.move(*scene_, motion_->moved());
    ASSERT_TRUE(creeping.render(lights_, camera_));
    drawn += creeping.shadow_maps_drawn();
    if (frame % 7 != 3) continue;
    // An outline of about 150 of the 19,200 pixels, a quarter of a texel off: an eighth of a pixel's light each.
    EXPECT_LE(off_from_anew(creeping), 0.125 * std::sqrt(2 * 150.0 / 19200)) << frame;
  }
  EXPECT_GE(drawn, 9u) << "each map more than once more";
  EXPECT_LE(drawn, 3u * kFrames / 2)
      << "half of all, at most: a step of 1.1 mm, quarters of texels of 2 to 7 mm";
  ASSERT_TRUE(motion_->move_to(0));
}

TEST_F(CreepingPictures, AMapThatIsDrawnAfterTheMotionShowsWhereThingsAre) {
  render::Renderer crept = renderer();
  crept.set_shadow_texels(1.0 / 16);
  ASSERT_TRUE(crept.render(lights_, camera_));
  // Less than a quarter of these maps' texels, then maps of a quarter of the texel.
  ASSERT_TRUE(motion_->move_to(0.1));
  crept.move(*scene_, motion_->moved());
  ASSERT_TRUE(crept.render(lights_, camera_));
  EXPECT_EQ(crept.shadow_maps_drawn(), 0u);
  crept.set_shadow_texels(1);
  ASSERT_TRUE(crept.render(lights_, camera_));
  EXPECT_EQ(crept.shadow_maps_drawn(), 3u);
  EXPECT_LE(off_from_anew(crept), 1e-4);
  ASSERT_TRUE(motion_->move_to(0));
}

// Toward a low light each step takes the ball's own surface before what the map shows.
TEST_F(CreepingPictures, NoSurfaceShadowsItselfWhileItsMapIsOff) {
  lights_ = light_set({{Vec3f(1, 0.15f, 0.5f), Rgb::Constant(1000)}});
  camera_ = camera_at({5, 1, 2.5f}, {0, 0.5f, 0});
  render::Renderer creeping = renderer();
  for (int frame = 0; frame < 20; ++frame) {
    ASSERT_TRUE(motion_->move_to(1 - 0.005 * frame));  // away from the light, and from the camera
    creeping.move(*scene_, motion_->moved());
    ASSERT_TRUE(creeping.render(lights_, camera_));
    EXPECT_LE(off_from_anew(creeping), 0.03) << frame;
  }
  ASSERT_TRUE(motion_->move_to(0));
}

}  // namespace
}  // namespace lightwell
