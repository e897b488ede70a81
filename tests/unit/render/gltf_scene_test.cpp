// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/gltf_scene.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "interface/atomic_file.h"
#include "render/casters.h"
#include "render/stage.h"
#include "tests/support/gltf_document.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::render {
namespace {

using nlohmann::json;
using test::Document;
using test::triangle;

Result<Scene> read(const std::string& text, const char* name = "scene.gltf") {
  const test::TemporaryFolder folder;
  EXPECT_TRUE(write_file_atomically(folder.path() / name, text));
  return read_gltf(folder.path() / name);
}

void expect_refused(const std::string& text, const std::string& why) {
  const auto scene = read(text);
  ASSERT_FALSE(scene.ok()) << why;
  EXPECT_EQ(scene.error().kind, ErrorKind::bad_input);
  EXPECT_NE(scene.error().message.find("scene.gltf: "), std::string::npos);
  EXPECT_NE(scene.error().message.find(why), std::string::npos) << scene.error().message;
  EXPECT_EQ(scene.error().message.find('\n'), std::string::npos);
}

TEST(GltfScene, MissingNormalsAreThoseOfTheTriangles) {
  Document d = triangle();
  const auto scene = read(d.text());
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  ASSERT_EQ(scene->triangles(), 1u);
  for (const auto i : scene->indices) EXPECT_EQ(scene->vertices[i].normal, Vec3f::UnitZ());
}

TEST(GltfScene, IndicesOfAllWidthsReadAlike) {
  const auto with = [](Document d, int accessor) {
    d.primitive()["indices"] = accessor;
    return read(d.text());
  };
  Document d8 = triangle();
  Document d16 = triangle();
  Document d32 = triangle();
  const int a8 = d8.add<std::uint8_t>({0, 2, 1}, "SCALAR", 5121, 1);
  const int a16 = d16.add<std::uint16_t>({0, 2, 1}, "SCALAR", 5123, 1);
  const int a32 = d32.add<std::uint32_t>({0, 2, 1}, "SCALAR", 5125, 1);
  for (const auto& scene : {with(d8, a8), with(d16, a16), with(d32, a32)}) {
    ASSERT_TRUE(scene.ok()) << scene.error().message;
    EXPECT_EQ(scene->vertices[scene->indices[1]].position, Vec3f::UnitY());
    EXPECT_EQ(scene->vertices[scene->indices[0]].normal, -Vec3f::UnitZ());
  }
}

TEST(GltfScene, TransformsMultiplyDownTheTreeAndMirrorsKeepFacesOutward) {
  Document d = triangle();
  d.primitive()["attributes"]["NORMAL"] = d.add<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 5126, 3);
  d.root["nodes"] = json::array(
      {{{"children", json::array({1})}, {"translation", {10, 0, 0}}}, {{"mesh", 0}, {"scale", {-2, 1, 3}}}});
  const auto scene = read(d.text());
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  const auto corner = [&](std::size_t i) { return scene->vertices[scene->indices[i]]; };
  EXPECT_EQ(corner(0).position, Vec3f(10, 0, 0));
  // The mirror reverses the corners; the surface still faces where its normals point, to +Z.
  const Vec3f face = (corner(1).position - corner(0).position).cross(corner(2).position - corner(0).position);
  EXPECT_GT(face.z(), 0);
  EXPECT_EQ(corner(0).normal, Vec3f::UnitZ());
}

TEST(GltfScene, RotationQuaternionIsXyzw) {
  Document d = triangle();
  const double h = std::sqrt(0.5);
  d.root["nodes"][0]["rotation"] = {0, h, 0, h};  // +90° about Y: +Z comes to +X
  const auto scene = read(d.text());
  ASSERT_TRUE(scene.ok());
  EXPECT_LT((scene->vertices[scene->indices[0]].normal - Vec3f::UnitX()).norm(), 1e-6f);
}

TEST(GltfScene, ExtrasSayPhongAndShadows) {
  Document d = triangle();
  d.root["materials"] = json::array(
      {{{"extras",
         {{"phong", {{"diffuse", {0.1, 0.2, 0.3}}, {"specular", {0.4, 0.5, 0.6}}, {"exponent", 7}}}}}}});
  d.primitive()["material"] = 0;
  d.root["nodes"] = json::array(
      {{{"children", json::array({1, 2})}, {"extras", {{"lightwell", {{"casts_shadow", false}}}}}},
       {{"mesh", 0}},
       {{"mesh", 0}, {"extras", {{"lightwell", {{"casts_shadow", true}}}}}}});
  const auto scene = read(d.text());
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  const Material& m = scene->materials[0];
  EXPECT_EQ(m.model, Material::Model::phong);
  EXPECT_TRUE((m.base_color == Rgb(0.1f, 0.2f, 0.3f)).all());
  EXPECT_TRUE((m.specular == Rgb(0.4f, 0.5f, 0.6f)).all());
  EXPECT_EQ(m.exponent, 7);
  ASSERT_EQ(scene->primitives.size(), 2u);
  EXPECT_FALSE(scene->primitives[0].casts_shadow);
  EXPECT_TRUE(scene->primitives[1].casts_shadow);
}

TEST(GltfScene, PhongOnANodeIsReadToo) {
  Document d = triangle();
  d.root["nodes"][0]["extras"] = {{"phong", {{"diffuse", {0.5, 0.5, 0.5}}}}};
  const auto scene = read(d.text());
  ASSERT_TRUE(scene.ok());
  EXPECT_EQ(scene->materials[static_cast<std::size_t>(scene->primitives[0].material)].model,
            Material::Model::phong);
}

TEST(GltfScene, CamerasLookAlongTheirNodesAxesWithoutScale) {
  Document d = triangle();
  d.root["cameras"] = json::array(
      {{{"type", "perspective"}, {"name", "main"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}}});
  d.root["nodes"] = json::array(
      {{{"mesh", 0}}, {{"camera", 0}, {"name", "tripod"}, {"scale", {3, 3, 3}}, {"translation", {0, 1, 4}}}});
  d.root["scenes"][0]["nodes"] = {0, 1};
  const auto scene = read(d.text());
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  ASSERT_EQ(scene->cameras.size(), 1u);
  EXPECT_EQ(scene->cameras[0].name, "main");
  EXPECT_EQ(scene->cameras[0].node_name, "tripod");
  EXPECT_TRUE(std::isinf(scene->cameras[0].far_m));
  Mat4f expected = Mat4f::Identity();
  expected.col(3) << 0, 1, 4, 1;
  EXPECT_EQ(scene->cameras[0].world_from_camera, expected);
}

TEST(GltfScene, StripsAndFansAreTriangles) {
  for (const int mode : {5, 6}) {
    Document d;
    d.primitive()["attributes"]["POSITION"] =
        mode == 5 ? d.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, "VEC3", 5126, 3)
                  : d.add<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, "VEC3", 5126, 3);
    d.primitive()["mode"] = mode;
    const auto scene = read(d.text());
    ASSERT_TRUE(scene.ok()) << scene.error().message;
    ASSERT_EQ(scene->triangles(), 2u);
    for (const auto i : scene->indices) EXPECT_EQ(scene->vertices[i].normal, Vec3f::UnitZ());
  }
}

TEST(GltfScene, TrianglesOfNoAreaAreDroppedAndCounted) {
  Document d;
  d.primitive()["attributes"]["POSITION"] =
      d.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 1, 2, 2, 2}, "VEC3", 5126, 3);
  const auto scene = read(d.text());
  ASSERT_TRUE(scene.ok());
  EXPECT_EQ(scene->triangles(), 1u);
  EXPECT_EQ(scene->dropped_triangles, 1u);
}

TEST(GltfScene, PrimitivesThatAreNotTrianglesAreNamed) {
  Document d = triangle();
  const json same = d.primitive();
  auto& primitives = d.root["meshes"][0]["primitives"];
  for (const int mode : {0, 1, 2, 3}) {
    primitives.push_back(same);
    primitives.back()["mode"] = mode;
  }
  const auto scene = read(d.text());
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  EXPECT_EQ(scene->primitives.size(), 1u);
  EXPECT_EQ(scene->left_out,
            (std::vector<std::string>{
                "mesh 0 primitive 1: mode 0 (points)", "mesh 0 primitive 2: mode 1 (lines)",
                "mesh 0 primitive 3: mode 2 (line loop)", "mesh 0 primitive 4: mode 3 (line strip)"}));
}

TEST(GltfScene, BadFilesAreRefusedInOneLineThatNamesTheReason) {
  expect_refused("", "");
  expect_refused("{", "");
  expect_refused("glTF", "");
  expect_refused(std::string("glTF\2\0\0\0\377\377\0\0", 12), "");
  expect_refused("[1,2,3]", "");
  expect_refused(R"({"asset":{"version":"2.0"}})", "no triangles");
  const std::string good = triangle().text();
  for (std::size_t cut = 1; cut < good.size(); cut += 37) EXPECT_FALSE(read(good.substr(0, cut)).ok());

  const auto refuse = [](const char* why, auto change) {
    Document d = triangle();
    d.text();
    change(d.root);
    expect_refused(d.root.contains("buffers") ? d.root.dump() : d.text(), why);
  };
  refuse("do not lie inside", [](json& r) { r["accessors"][0]["count"] = 4; });
  refuse("do not lie inside", [](json& r) { r["accessors"][0]["count"] = 4611686018427387904; });
  refuse("do not lie inside", [](json& r) { r["accessors"][0]["byteOffset"] = 4; });
  refuse("out of range", [](json& r) { r["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 7; });
  refuse("bufferView", [](json& r) { r["accessors"][0]["bufferView"] = 9; });
  refuse("wrong type", [](json& r) { r["accessors"][0]["type"] = "VEC2"; });
  refuse("no POSITION", [](json& r) { r["meshes"][0]["primitives"][0]["attributes"] = {{"NORMAL", 0}}; });
  refuse("out of range", [](json& r) { r["nodes"][0]["mesh"] = 3; });
  refuse("out of range", [](json& r) { r["scenes"][0]["nodes"] = {5}; });
  refuse("circle", [](json& r) { r["nodes"][0]["children"] = {0}; });
  refuse("material 4", [](json& r) { r["meshes"][0]["primitives"][0]["material"] = 4; });
  refuse("KHR_draco", [](json& r) { r["extensionsRequired"] = {"KHR_draco_mesh_compression"}; });
  refuse("", [](json& r) { r["buffers"][0]["uri"] = "missing.bin"; });
  refuse("", [](json& r) { r["buffers"][0]["byteLength"] = 1000000; });
  refuse("casts_shadow", [](json& r) { r["nodes"][0]["extras"] = {{"lightwell", {{"casts_shadow", 3}}}}; });
  refuse("exponent", [](json& r) { r["nodes"][0]["extras"] = {{"phong", {{"exponent", -1}}}}; });
  refuse("no triangles", [](json& r) { r["nodes"][0]["scale"] = {0, 0, 0}; });
  refuse("not finite", [](json& r) { r["nodes"][0]["scale"] = {1e300, 1, 1}; });
}

TEST(GltfScene, ValuesThatAreNotFiniteAndIndicesOutOfRangeAreRefused) {
  Document d;
  d.primitive()["attributes"]["POSITION"] =
      d.add<float>({0, 0, 0, std::nanf(""), 0, 0, 0, 1, 0}, "VEC3", 5126, 3);
  expect_refused(d.text(), "element 1 is not finite");
  Document e = triangle();
  e.primitive()["indices"] = e.add<std::uint16_t>({0, 1, 3}, "SCALAR", 5123, 1);
  expect_refused(e.text(), "index 3 is out of range");
}

TEST(GltfScene, MissingFilesAndFoldersAreBadInput) {
  EXPECT_EQ(read_gltf("/nonexistent/scene.gltf").error().kind, ErrorKind::bad_input);
  EXPECT_EQ(read_gltf("/").error().kind, ErrorKind::bad_input);
}

TEST(Stage, HasTheTrianglesItNamesClosedCastersAndAGroundThatOnlyReceives) {
  const auto scene = read(stage_gltf());
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  EXPECT_EQ(scene->triangles(), 16194u);
  EXPECT_EQ(scene->dropped_triangles, 0u);
  EXPECT_EQ(scene->cameras.at(0).name, "stage");
  const Casters casters = find_casters(*scene);
  EXPECT_EQ(casters.closed_count, (16194u - 2) * 3);
  EXPECT_EQ(casters.open_count + casters.support_count, 0u);
  // Outward faces enclose a positive volume (divergence theorem), mesh by mesh, and normals agree with them.
  for (std::size_t p = 1; p < scene->primitives.size(); ++p) {
    double volume = 0;
    for (std::uint32_t i = 0; i < scene->primitives[p].index_count; i += 3) {
      const auto corner = [&](std::uint32_t k) {
        return scene->vertices[scene->indices[scene->primitives[p].first_index + i + k]];
      };
      const Vec3f cross =
          (corner(1).position - corner(0).position).cross(corner(2).position - corner(0).position);
      volume += corner(0).position.dot(cross) / 6;
      EXPECT_GT(cross.normalized().dot(corner(0).normal), 0.5f);
    }
    EXPECT_GT(volume, 0) << p;
  }
}

}  // namespace
}  // namespace lightwell::render
