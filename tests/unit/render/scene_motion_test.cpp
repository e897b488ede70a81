// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/scene_motion.h"

#include <gtest/gtest.h>

#include "interface/atomic_file.h"
#include "render/caster_mesh.h"
#include "render/casters.h"
#include "render/gltf_scene.h"
#include "render/surface_distance.h"
#include "tests/support/gltf_document.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::render {
namespace {

using test::animate;
using test::Document;
using test::json;
using test::triangle;

Result<Scene> read(Document d, const std::string& animation = "") {
  const test::TemporaryFolder folder;
  EXPECT_TRUE(write_file_atomically(folder.path() / "scene.gltf", d.text()));
  return read_gltf(folder.path() / "scene.gltf", animation);
}

void expect_refused(const Document& d, const std::string& why) {
  const auto scene = read(d);
  ASSERT_FALSE(scene.ok()) << why;
  EXPECT_EQ(scene.error().kind, ErrorKind::bad_input);
  EXPECT_NE(scene.error().message.find(why), std::string::npos) << scene.error().message;
}

Vec3f corner(const Scene& scene, std::size_t i) {
  return scene.vertices[scene.indices[i]].position;
}

void expect_near(const Vec3f& actual, const Vec3f& expected, const char* what = "") {
  // A few roundings of single precision of numbers about 1.
  EXPECT_LT((actual - expected).norm(), 2e-6f) << what << ": " << actual.transpose();
}

TEST(SceneMotion, ANodeFollowsItsTracksAndItsParents) {
  Document d = triangle();
  d.root["nodes"] =
      json::array({{{"children", json::array({1})}}, {{"mesh", 0}, {"translation", {0, 2, 0}}}});
  const float h = std::sqrt(0.5f);
  animate(d, 0, "rotation", {0, 1}, {0, 0, 0, 1, 0, h, 0, h}, "VEC4", 4);  // 90° about Y in a second
  animate(d, 0, "translation", {0, 1}, {0, 0, 0, 10, 0, 0}, "VEC3", 3);
  animate(d, 1, "scale", {0, 1}, {1, 1, 1, 3, 3, 3}, "VEC3", 3, "STEP");
  auto scene = read(d);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  EXPECT_TRUE(scene->primitives[0].moves);
  expect_near(corner(*scene, 1), {1, 2, 0});
  SceneMotion motion(*scene);
  ASSERT_TRUE(motion.move_to(0.5));
  EXPECT_EQ(motion.moved().size(), 1u);
  // 45° about Y carries +X to (h, 0, −h); the scale has not come yet.
  expect_near(corner(*scene, 0), {5, 2, 0});
  expect_near(corner(*scene, 1), {5 + h, 2, -h});
  expect_near(scene->vertices[scene->indices[0]].normal, {h, 0, h});
  // At its end it begins again.
  ASSERT_TRUE(motion.move_to(3.5));
  EXPECT_TRUE(motion.moved().empty());
  expect_near(corner(*scene, 0), {5, 2, 0});
  ASSERT_TRUE(motion.move_to(1));
  expect_near(corner(*scene, 1), {1, 2, 0});
}

TEST(SceneMotion, WhatHoldsStillIsNotAmongTheMoved) {
  Document d = triangle();
  d.root["nodes"] = json::array({{{"mesh", 0}}, {{"mesh", 0}}, {{"mesh", 0}}});
  d.root["scenes"][0]["nodes"] = {0, 1, 2};
  animate(d, 0, "translation", {0, 4}, {0, 0, 0, 4, 0, 0}, "VEC3", 3);
  animate(d, 2, "translation", {1, 2, 4}, {0, 0, 0, 1, 0, 0, 1, 0, 0}, "VEC3", 3);
  auto scene = read(d);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  EXPECT_FALSE(scene->primitives[1].moves);
  SceneMotion motion(*scene);
  const auto moved_at = [&](double time_s) {
    EXPECT_TRUE(motion.move_to(time_s));
    return std::vector<std::size_t>(motion.moved().begin(), motion.moved().end());
  };
  EXPECT_EQ(moved_at(0.5), std::vector<std::size_t>{0});
  EXPECT_EQ(moved_at(1.5), (std::vector<std::size_t>{0, 2}));
  EXPECT_EQ(moved_at(3), (std::vector<std::size_t>{0, 2}));
  EXPECT_EQ(moved_at(3.5), std::vector<std::size_t>{0});
  EXPECT_EQ(moved_at(3.5), std::vector<std::size_t>{});
}

// A bar along +Y of two bones, hinged at y = 1: below it hangs on the first, above on the second, at it on both.
Document bar(bool eight_influences = false, float weight_scale = 1) {
  Document d;
  json& attributes = d.primitive()["attributes"];
  attributes["POSITION"] = d.add<float>({0, 0, 0, 0.5f, 1, 0, 0, 2, 0, 0, 1, 0}, "VEC3", 5126, 3);
  attributes["NORMAL"] = d.add<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 5126, 3);
  const std::string set = eight_influences ? "1" : "0";
  if (eight_influences) {
    attributes["JOINTS_0"] = d.add<std::uint8_t>(std::vector<std::uint8_t>(16, 0), "VEC4", 5121, 4);
    attributes["WEIGHTS_0"] = d.add<float>(std::vector<float>(16, 0), "VEC4", 5126, 4);
  }
  attributes["JOINTS_" + set] =
      d.add<std::uint16_t>({0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, "VEC4", 5123, 4);
  std::vector<float> weights = {1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 0, 1, 0, 0, 0.5f, 0.5f, 0, 0};
  for (float& w : weights) w *= weight_scale;
  attributes["WEIGHTS_" + set] = d.add<float>(weights, "VEC4", 5126, 4);
  d.primitive()["indices"] = d.add<std::uint16_t>({0, 1, 2, 0, 1, 3}, "SCALAR", 5123, 1);
  // Column-major; the second takes the hinge to the origin.
  const int matrices = d.add<float>(
      {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1},
      "MAT4", 5126, 16);
  d.root["skins"] = json::array({{{"joints", {1, 2}}, {"inverseBindMatrices", matrices}}});
  // The mesh's own node is far away, which has no part in where a skin stands.
  d.root["nodes"] = json::array({{{"mesh", 0}, {"skin", 0}, {"translation", {50, 0, 0}}},
                                 {{"children", json::array({2})}},
                                 {{"translation", {0, 1, 0}}}});
  d.root["scenes"][0]["nodes"] = {0, 1};
  const float h = std::sqrt(0.5f);
  animate(d, 2, "rotation", {0, 1, 2}, {0, 0, 0, 1, 0, 0, h, h, 0, 0, h, h}, "VEC4", 4);  // to 90° about Z
  return d;
}

TEST(SceneMotion, ASkinBendsWithItsJointsByTheWeights) {
  for (const bool eight : {false, true})
    for (const float weight_scale : {1.0f, 0.25f}) {  // weights that do not sum to 1 are brought to it
      auto scene = read(bar(eight, weight_scale));
      ASSERT_TRUE(scene.ok()) << scene.error().message;
      expect_near(corner(*scene, 2), {0, 2, 0}, "at rest");
      SceneMotion motion(*scene);
      ASSERT_TRUE(motion.move_to(1.5));
      expect_near(corner(*scene, 0), {0, 0, 0}, "first bone");
      // 90° about Z through (0, 1, 0) carries (0, 2, 0) to (−1, 1, 0) and (0.5, 1, 0) to (0, 1.5, 0).
      expect_near(corner(*scene, 2), {-1, 1, 0}, "second bone");
      expect_near(corner(*scene, 1), Vec3f(0.25f, 1.25f, 0), "between both");
    }
}

TEST(SceneMotion, ASkinThatNothingMovesStandsAsItsJointsDo) {
  Document d = bar();
  d.root.erase("animations");
  d.root["nodes"][2]["rotation"] = {0, 0, std::sqrt(0.5), std::sqrt(0.5)};
  const auto scene = read(d);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  EXPECT_FALSE(scene->rig.moves());
  expect_near(corner(*scene, 2), {-1, 1, 0});
}

Document morphing() {
  Document d = triangle();
  d.primitive()["attributes"]["NORMAL"] = d.add<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 5126, 3);
  const int up = d.add<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 5126, 3);
  const int wide = d.add<float>({0, 0, 0, 2, 0, 0, 0, 0, 0}, "VEC3", 5126, 3);
  const int turned = d.add<float>({1, 0, -1, 1, 0, -1, 1, 0, -1}, "VEC3", 5126, 3);
  d.primitive()["targets"] = json::array({{{"POSITION", up}}, {{"POSITION", wide}, {"NORMAL", turned}}});
  return d;
}

TEST(SceneMotion, MorphTargetsAddByTheirWeights) {
  Document still = morphing();
  still.root["meshes"][0]["weights"] = {0.5, 1};
  const auto standing = read(still);
  ASSERT_TRUE(standing.ok()) << standing.error().message;
  EXPECT_FALSE(standing->rig.moves());
  expect_near(corner(*standing, 1), {3, 0, 0.5f});
  expect_near(standing->vertices[standing->indices[0]].normal, Vec3f::UnitX());
  // A node's own weights come before its mesh's.
  still.root["nodes"][0]["weights"] = {0, 0.5};
  expect_near(corner(*read(still), 1), {2, 0, 0});

  Document d = morphing();
  animate(d, 0, "weights", {0, 2}, {0, 0, 1, 0.5f}, "SCALAR", 1);
  auto scene = read(d);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  SceneMotion motion(*scene);
  ASSERT_TRUE(motion.move_to(1));
  expect_near(corner(*scene, 1), {1.5f, 0, 0.5f});
  expect_near(scene->vertices[scene->indices[0]].normal, Vec3f(0.25f, 0, 0.75f).normalized());
}

TEST(SceneMotion, TrianglesWithoutNormalsGetThoseOfWhereTheyAre) {
  Document d = triangle();
  const int lift = d.add<float>({0, 0, 0, 0, 0, 0, 0, -1, 1}, "VEC3", 5126, 3);  // (0,1,0) to (0,0,1)
  d.primitive()["targets"] = json::array({{{"POSITION", lift}}});
  animate(d, 0, "weights", {0, 1, 2}, {0, 1, 1}, "SCALAR", 1);
  auto scene = read(d);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  SceneMotion motion(*scene);
  ASSERT_TRUE(motion.move_to(1.5));
  expect_near(scene->vertices[scene->indices[0]].normal, -Vec3f::UnitY());
}

TEST(SceneMotion, WhatGrowsFromNothingIsThereInTime) {
  Document d = triangle();
  animate(d, 0, "scale", {0, 1, 2}, {0, 0, 0, 2, 2, 2, 2, 2, 2}, "VEC3", 3);
  auto scene = read(d);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  expect_near(corner(*scene, 1), Vec3f::Zero());
  SceneMotion motion(*scene);
  ASSERT_TRUE(motion.move_to(1.5));
  expect_near(corner(*scene, 1), {2, 0, 0});
  expect_near(scene->vertices[scene->indices[1]].normal, Vec3f::UnitZ());
}

// Triangles keep the order of their corners, so those that mirror later are seen from behind; their normals stand
// on the side of that order, and what draws them turns normals of back faces round.
TEST(SceneMotion, WhatTurnsInsideOutIsSeenFromBothSides) {
  Document d = triangle();
  d.primitive()["attributes"]["NORMAL"] = d.add<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 5126, 3);
  animate(d, 0, "scale", {0, 1, 2}, {1, 1, 1, -1, 1, 1, -1, 1, 1}, "VEC3", 3);
  auto scene = read(d);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  EXPECT_TRUE(scene->primitives[0].turns_inside_out);
  SceneMotion motion(*scene);
  ASSERT_TRUE(motion.move_to(1.5));
  const Vec3f face = (corner(*scene, 1) - corner(*scene, 0)).cross(corner(*scene, 2) - corner(*scene, 0));
  EXPECT_GT(face.dot(scene->vertices[scene->indices[0]].normal), 0);
  EXPECT_EQ(find_casters(*scene).closed_count, 0u);
}

TEST(SceneMotion, AnAnimatedCameraMoves) {
  Document d = triangle();
  d.root["cameras"] =
      json::array({{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}}});
  d.root["nodes"] =
      json::array({{{"mesh", 0}}, {{"children", json::array({2})}}, {{"camera", 0}, {"scale", {2, 2, 2}}}});
  d.root["scenes"][0]["nodes"] = {0, 1};
  animate(d, 1, "translation", {0, 1, 2}, {0, 0, 5, 4, 0, 5, 4, 0, 5}, "VEC3", 3);
  auto scene = read(d);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  SceneMotion motion(*scene);
  ASSERT_TRUE(motion.move_to(0.5));
  EXPECT_TRUE(motion.camera_moved());
  EXPECT_TRUE(motion.moved().empty());
  Mat4f expected = Mat4f::Identity();
  expected.col(3) << 2, 0, 5, 1;
  EXPECT_EQ(scene->cameras[0].world_from_camera, expected);
  ASSERT_TRUE(motion.move_to(1.2));
  ASSERT_TRUE(motion.move_to(1.6));
  EXPECT_FALSE(motion.camera_moved());
}

TEST(SceneMotion, ANameChoosesTheAnimationAndTheFirstIsShownWithoutOne) {
  Document d = triangle();
  animate(d, 0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0}, "VEC3", 3);
  d.root["animations"][0]["name"] = "walk";
  d.root["animations"].push_back(
      {{"name", "stand"}, {"channels", json::array()}, {"samplers", json::array()}});
  const auto first = read(d);
  ASSERT_TRUE(first.ok()) << first.error().message;
  EXPECT_TRUE(first->rig.moves());
  ASSERT_EQ(first->remarks.size(), 1u);
  EXPECT_NE(first->remarks[0].find("'walk', 'stand'"), std::string::npos);
  const auto second = read(d, "stand");
  ASSERT_TRUE(second.ok()) << second.error().message;
  EXPECT_FALSE(second->rig.moves());
  const auto none = read(d, "run");
  ASSERT_FALSE(none.ok());
  EXPECT_EQ(none.error().kind, ErrorKind::usage);
  EXPECT_NE(none.error().message.find("'run', the file has 'walk', 'stand'"), std::string::npos);
}

TEST(SceneMotion, BadAnimationsAreRefusedByName) {
  const auto refuse = [](const char* why, auto change) {
    Document d = triangle();
    animate(d, 0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0}, "VEC3", 3);
    change(d);
    expect_refused(d, why);
  };
  const auto channel = [](Document& d) -> json& { return d.root["animations"][0]["channels"][0]; };
  const auto sampler = [](Document& d) -> json& { return d.root["animations"][0]["samplers"][0]; };
  refuse("animation 0 channel 0: sampler 3 is out of range", [&](Document& d) { channel(d)["sampler"] = 3; });
  refuse("animation 0 channel 0: node 9", [&](Document& d) { channel(d)["target"]["node"] = 9; });
  refuse("path 'colour'", [&](Document& d) { channel(d)["target"]["path"] = "colour"; });
  refuse("has no morph targets", [&](Document& d) { channel(d)["target"]["path"] = "weights"; });
  refuse("wrong type", [&](Document& d) { channel(d)["target"]["path"] = "rotation"; });
  refuse("interpolation 'SMOOTH'", [&](Document& d) { sampler(d)["interpolation"] = "SMOOTH"; });
  refuse("6 numbers for 2 times, must be 18",
         [&](Document& d) { sampler(d)["interpolation"] = "CUBICSPLINE"; });
  refuse("input: accessor 77", [&](Document& d) { sampler(d)["input"] = 77; });
  refuse("times must rise", [&](Document& d) {
    sampler(d)["input"] = d.add<float>({1, 1}, "SCALAR", 5126, 1);
  });
  refuse("times must rise", [&](Document& d) {
    sampler(d)["input"] = d.add<float>({-1, 1}, "SCALAR", 5126, 1);
  });
  refuse("not finite", [&](Document& d) {
    sampler(d)["input"] = d.add<float>({0, std::nanf("")}, "SCALAR", 5126, 1);
  });
  refuse("has a matrix", [&](Document& d) {
    d.root["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  });
  refuse("rotation 1 is 0", [&](Document& d) {
    animate(d, 0, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, 0, 0}, "VEC4", 4);
  });
}

TEST(SceneMotion, BadSkinsAndTargetsAreRefusedByName) {
  const auto refuse = [](const char* why, auto change) {
    Document d = bar();
    change(d);
    expect_refused(d, why);
  };
  const auto attributes = [](Document& d) -> json& { return d.primitive()["attributes"]; };
  refuse("node 0: skin 4", [](Document& d) { d.root["nodes"][0]["skin"] = 4; });
  refuse("joint 8 is out of range", [](Document& d) { d.root["skins"][0]["joints"] = {1, 8}; });
  refuse("joint 2 is not in the scene", [](Document& d) { d.root["nodes"][1].erase("children"); });
  refuse("2 inverseBindMatrices for 3 joints", [](Document& d) { d.root["skins"][0]["joints"] = {1, 2, 0}; });
  refuse("no JOINTS_0", [&](Document& d) {
    attributes(d).erase("JOINTS_0");
    attributes(d).erase("WEIGHTS_0");
  });
  refuse("come together", [&](Document& d) { attributes(d).erase("WEIGHTS_0"); });
  refuse("hangs on joint 1, the skin has 1", [](Document& d) { d.root["skins"][0]["joints"] = {1}; });
  refuse("must be 0 or more", [&](Document& d) {
    attributes(d)["WEIGHTS_0"] = d.add<float>(std::vector<float>(16, -0.5f), "VEC4", 5126, 4);
  });
  refuse("differ in count", [&](Document& d) {
    attributes(d)["JOINTS_0"] = d.add<std::uint8_t>({0, 0, 0, 0}, "VEC4", 5121, 4);
  });
  refuse("target 0 POSITION and POSITION differ in count", [](Document& d) {
    const int few = d.add<float>({0, 0, 0}, "VEC3", 5126, 3);
    d.primitive()["targets"] = json::array({{{"POSITION", few}}});
  });
}

TEST(SceneMotion, AWayToInfinityIsNamed) {
  Document d = triangle();
  animate(d, 0, "translation", {0, 1}, {0, 0, 0, 1e38f, 0, 0}, "VEC3", 3);
  animate(d, 0, "scale", {0, 1}, {1, 1, 1, 3e38f, 1, 1}, "VEC3", 3);
  auto scene = read(d);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  SceneMotion motion(*scene);
  const Status status = motion.move_to(0.999);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().kind, ErrorKind::bad_input);
}

// Two triangles that stand on a floor; one of them walks.
Document walkers() {
  Document d = triangle();
  d.root["nodes"] = json::array({{{"mesh", 0}}, {{"mesh", 0}, {"translation", {5, 0, 0}}}});
  d.root["scenes"][0]["nodes"] = {0, 1};
  animate(d, 1, "translation", {0, 2}, {5, 0, 0, 25, 0, 0}, "VEC3", 3);
  return d;
}

TEST(MovingCasters, FollowTheirVerticesAndBoundThem) {
  auto scene = read(walkers());
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  Casters casters = find_casters(*scene);
  SceneMotion motion(*scene);
  double last_s = 0;
  for (const double time_s : {0.3, 1.0, 1.9}) {
    ASSERT_TRUE(motion.move_to(time_s));
    const Vec3f before = casters.parts[0].bounds.centre;
    // The walker goes 10 m a second along x, and does not turn.
    EXPECT_NEAR(casters.farthest_move(*scene, motion.moved()), 10 * (time_s - last_s), 1e-4);
    last_s = time_s;
    casters.move(*scene, motion.moved());
    EXPECT_EQ(casters.farthest_move(*scene, motion.moved()), 0);
    const Casters anew = find_casters(*scene);
    EXPECT_EQ(casters.objects.centre, anew.objects.centre);
    EXPECT_EQ(casters.objects.radius, anew.objects.radius);
    EXPECT_EQ(casters.scene.radius, anew.scene.radius);
    ASSERT_EQ(casters.positions.size(), anew.positions.size());
    for (std::size_t i = 0; i < anew.positions.size(); ++i)
      EXPECT_EQ(casters.positions[i], anew.positions[i]);
    // What stands still is a support, which comes last.
    ASSERT_EQ(casters.parts.size(), 2u);
    EXPECT_EQ(casters.parts[0].primitive, 1u);
    EXPECT_TRUE(casters.parts[0].moved);
    EXPECT_FALSE(casters.parts[1].moved);
    EXPECT_EQ(casters.parts[0].bounds.radius, anew.parts[0].bounds.radius);
    EXPECT_LT(before.x(), casters.parts[0].bounds.centre.x());
  }
  casters.move(*scene, {});
  EXPECT_FALSE(casters.parts[0].moved);
}

TEST(MovingCasters, OfACylinderThatBendsKeepTheirBoundInEveryPose) {
  // A closed tube along +Y whose rings, all but straight ones at rest, bend to a quarter circle.
  Document d;
  std::vector<float> positions;
  std::vector<float> bent;
  constexpr std::uint16_t kRings = 33;
  constexpr std::uint16_t kSides = 12;
  for (int r = 0; r < kRings; ++r)
    for (int s = 0; s < kSides; ++s) {
      const double t = static_cast<double>(r) / (kRings - 1);
      const double across = 2 * kPi * s / kSides;
      const Vec3d p(0.1 * std::cos(across), 2 * t, 0.1 * std::sin(across));
      const double angle = t * kPi / 2;
      const double radius = 4 / kPi - p.x();
      const Vec3d q(4 / kPi - radius * std::cos(angle), radius * std::sin(angle), p.z());
      for (int c = 0; c < 3; ++c) {
        positions.push_back(static_cast<float>(p[c]));
        bent.push_back(static_cast<float>(q[c] - p[c]));
      }
    }
  std::vector<std::uint16_t> triangles;
  const auto at = [](int r, int s) { return static_cast<std::uint16_t>(r * kSides + s % kSides); };
  for (int r = 0; r + 1 < kRings; ++r)
    for (int s = 0; s < kSides; ++s)
      triangles.insert(triangles.end(),
                       {at(r, s), at(r + 1, s), at(r, s + 1), at(r, s + 1), at(r + 1, s), at(r + 1, s + 1)});
  for (int s = 1; s + 1 < kSides; ++s) {
    triangles.insert(triangles.end(), {at(0, 0), at(0, s), at(0, s + 1)});
    triangles.insert(triangles.end(), {at(kRings - 1, 0), at(kRings - 1, s + 1), at(kRings - 1, s)});
  }
  d.primitive()["attributes"]["POSITION"] = d.add<float>(positions, "VEC3", 5126, 3);
  d.primitive()["indices"] = d.add<std::uint16_t>(triangles, "SCALAR", 5123, 1);
  const int target = d.add<float>(bent, "VEC3", 5126, 3);
  d.primitive()["targets"] = json::array({{{"POSITION", target}}});
  animate(d, 0, "weights", {0, 1, 2}, {0, 1, 0}, "SCALAR", 1);
  auto scene = read(d);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  Casters full = find_casters(*scene);
  constexpr int kMap = 64;
  Casters fewer = find_casters(*scene, kMap);
  EXPECT_LT(fewer.indices.size(), full.indices.size());
  EXPECT_EQ(fewer.closed_count, fewer.indices.size());
  const double bound_m = kSimplifiedTexels * 2 * full.objects.radius / kMap;
  SceneMotion motion(*scene);
  // Poses between those that were looked at bend no more than their neighbours.
  for (const double time_s : {0.0, 0.125, 0.375, 0.625, 0.875}) {
    ASSERT_TRUE(motion.move_to(time_s));
    full.move(*scene, motion.moved());
    fewer.move(*scene, motion.moved());
    std::vector<Vec3f> all = full.positions;
    all.insert(all.end(), fewer.positions.begin(), fewer.positions.end());
    std::vector<std::uint32_t> shifted = fewer.indices;
    for (auto& i : shifted) i += static_cast<std::uint32_t>(full.positions.size());
    EXPECT_TRUE(stay_together(full.indices, shifted, all, bound_m * (1 + 1e-5))) << time_s;
  }
}

TEST(MovingCasters, WhatSinksIntoAFloorToItsMiddleLeavesItASupport) {
  for (const float lowest : {-0.2f, -2.0f}) {
    Document d = triangle();
    const int floor = d.add<float>({-9, 0, 9, 9, 0, 9, 0, 0, -9}, "VEC3", 5126, 3);
    d.root["meshes"].push_back({{"primitives", json::array({{{"attributes", {{"POSITION", floor}}}}})}});
    d.root["nodes"] = json::array({{{"mesh", 0}}, {{"mesh", 1}}});
    d.root["scenes"][0]["nodes"] = {0, 1};
    animate(d, 0, "translation", {0, 1, 2}, {0, 0, 0, 0, lowest, 0, 0, 0, 0}, "VEC3", 3);
    const auto scene = read(d);
    ASSERT_TRUE(scene.ok()) << scene.error().message;
    EXPECT_EQ(find_casters(*scene).is_support[1], lowest > -0.5f);
  }
}

}  // namespace
}  // namespace lightwell::render
