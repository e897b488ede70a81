// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "interface/atomic_file.h"
#include "render/gltf_scene.h"
#include "render/picture.h"
#include "tests/support/gltf_document.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::render {
namespace {

using test::Document;
using test::json;
using test::triangle;

// The file has beside it a picture of 2×1 pixels, red and half transparent green: picture.png.
Result<Scene> read(Document d) {
  const test::TemporaryFolder folder;
  EXPECT_TRUE(write_png(folder.path() / "picture.png", {2, 1, {255, 0, 0, 255, 0, 255, 0, 128}}));
  EXPECT_TRUE(write_file_atomically(folder.path() / "scene.gltf", d.text()));
  return read_gltf(folder.path() / "scene.gltf");
}

Document textured() {
  Document d = triangle();
  json& attributes = d.primitive()["attributes"];
  attributes["TEXCOORD_0"] = d.add<float>({0, 0, 1, 0, 0, 1}, "VEC2", 5126, 2);
  attributes["TEXCOORD_1"] = d.add<float>({5, 5, 6, 5, 5, 6}, "VEC2", 5126, 2);
  d.primitive()["material"] = 0;
  d.root["images"] = json::array({{{"uri", "picture.png"}}});
  d.root["textures"] = json::array({{{"source", 0}}});
  d.root["materials"] = json::array({{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}});
  return d;
}

json& texture_info(Document& d) {
  return d.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
}

void expect_refused(const Document& d, const std::string& why) {
  const auto scene = read(d);
  ASSERT_FALSE(scene.ok()) << why;
  EXPECT_EQ(scene.error().kind, ErrorKind::bad_input);
  EXPECT_NE(scene.error().message.find(why), std::string::npos) << scene.error().message;
  EXPECT_EQ(scene.error().message.find('\n'), std::string::npos);
}

const Material& material(const Scene& scene) {
  return scene.materials[static_cast<std::size_t>(scene.primitives[0].material)];
}

TEST(GltfMaterial, PicturesKeepTheirAlphaAndSamplersSayHowTheyWrap) {
  Document d = textured();
  d.root["samplers"] =
      json::array({{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}, {"minFilter", 9984}}});
  d.root["textures"][0]["sampler"] = 0;
  const auto scene = read(d);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  ASSERT_EQ(scene->textures.size(), 1u);
  EXPECT_EQ(scene->textures[0].rgba, (std::vector<std::uint8_t>{255, 0, 0, 255, 0, 255, 0, 128}));
  EXPECT_EQ(scene->textures[0].wrap_u, 33071);
  EXPECT_EQ(scene->textures[0].wrap_v, 33648);
  EXPECT_EQ(scene->textures[0].mag_filter, 9728);
  EXPECT_EQ(scene->textures[0].min_filter, 9984);
}

// Scale, then the turn, counter-clockwise as one sees it with v pointing down, then the offset.
TEST(GltfMaterial, TextureTransformsScaleTurnAndShift) {
  Document d = textured();
  texture_info(d)["extensions"]["KHR_texture_transform"] = {
      {"offset", {0.5, 0.25}}, {"rotation", kPi / 2}, {"scale", {2, 3}}};
  const auto scene = read(d);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  // (1, 0) scaled to (2, 0), turned to (0, −2); (0, 1) to (0, 3), to (3, 0).
  const std::array<float, 6> expected = {0, 3, 0.5f, -2, 0, 0.25f};
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_NEAR(material(*scene).base_color_texture.from_uv[i], expected[i], 1e-6f);
}

TEST(GltfMaterial, AllTexturesOfAMaterialUseOneSetOfCoordinatesWhicheverItIs) {
  Document d = textured();
  texture_info(d)["texCoord"] = 1;
  const auto second = read(d);
  ASSERT_TRUE(second.ok()) << second.error().message;
  EXPECT_EQ(second->vertices[0].uv, Vec2f(5, 5));
  d.root["materials"][0]["normalTexture"] = {{"index", 0}};
  expect_refused(d, "TEXCOORD_0, another texture of the material TEXCOORD_1");
  texture_info(d)["extensions"]["KHR_texture_transform"]["texCoord"] = 0;
  const auto first = read(d);
  ASSERT_TRUE(first.ok()) << first.error().message;
  EXPECT_EQ(first->vertices[0].uv, Vec2f(0, 0));
}

TEST(GltfMaterial, NormalEmissionAndAlphaAreRead) {
  Document d = textured();
  json& m = d.root["materials"][0];
  m["normalTexture"] = {{"index", 0}, {"scale", 0.5}};
  m["emissiveFactor"] = {0.5, 0.25, 1};
  m["emissiveTexture"] = {{"index", 0}};
  m["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = 100;
  m["alphaMode"] = "MASK";
  m["alphaCutoff"] = 0.3;
  m["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 0.75};
  m["occlusionTexture"] = {{"index", 0}, {"texCoord", 1}};
  d.root["extensionsUsed"] = {"KHR_materials_emissive_strength", "KHR_materials_unlit",
                              "KHR_lights_punctual"};
  const auto scene = read(d);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  EXPECT_EQ(material(*scene).normal_texture.texture, 0);
  EXPECT_FLOAT_EQ(material(*scene).normal_scale, 0.5f);
  EXPECT_TRUE((material(*scene).emission == Rgb(50, 25, 100)).all());
  EXPECT_EQ(material(*scene).emission_texture.texture, 0);
  EXPECT_FLOAT_EQ(material(*scene).alpha_cutoff, 0.3f);
  EXPECT_FLOAT_EQ(material(*scene).alpha, 0.75f);
  std::string remarks;
  for (const auto& r : scene->remarks) remarks += r + "\n";
  EXPECT_NE(remarks.find("KHR_materials_unlit, KHR_lights_punctual"), std::string::npos) << remarks;
  EXPECT_NE(remarks.find("occlusion"), std::string::npos) << remarks;
  EXPECT_EQ(remarks.find("emissive_strength"), std::string::npos) << remarks;
}

TEST(GltfMaterial, AlphaCountsOnlyWhereTheMaterialSaysSo) {
  Document d = textured();
  const auto opaque = read(d);
  ASSERT_TRUE(opaque.ok());
  EXPECT_EQ(material(*opaque).alpha_cutoff, 0);
  d.root["materials"][0]["alphaMode"] = "BLEND";
  const auto blended = read(d);
  ASSERT_TRUE(blended.ok());
  EXPECT_EQ(material(*blended).alpha_cutoff, 0.5f);
  ASSERT_EQ(blended->remarks.size(), 1u);
  EXPECT_NE(blended->remarks[0].find("material 0: alphaMode BLEND"), std::string::npos);
}

TEST(GltfMaterial, VertexColoursOfThreeAndFourComponentsAndAllWidthsReadAlike) {
  const std::array<std::uint16_t, 4> expected = {65535, 0, 13107, 65535};
  for (int kind = 0; kind < 3; ++kind) {
    Document d = triangle();
    const auto three = [](auto one) {
      auto all = one;
      for (int i = 0; i < 2; ++i) all.insert(all.end(), one.begin(), one.end());
      return all;
    };
    int accessor = 0;
    if (kind == 0) accessor = d.add<float>(three(std::vector<float>{1.5f, -1, 0.2f}), "VEC3", 5126, 3);
    if (kind == 1)
      accessor = d.add<std::uint8_t>(three(std::vector<std::uint8_t>{255, 0, 51, 255}), "VEC4", 5121, 4);
    if (kind == 2)
      accessor =
          d.add<std::uint16_t>(three(std::vector<std::uint16_t>{65535, 0, 13107, 65535}), "VEC4", 5123, 4);
    if (kind > 0) d.root["accessors"][static_cast<std::size_t>(accessor)]["normalized"] = true;
    d.primitive()["attributes"]["COLOR_0"] = accessor;
    const auto scene = read(d);
    ASSERT_TRUE(scene.ok()) << scene.error().message;
    EXPECT_EQ(scene->vertices[0].color, expected) << kind;
  }
}

TEST(GltfMaterial, BadMaterialsAreRefusedByName) {
  const auto refuse = [](const char* why, auto change) {
    Document d = textured();
    change(d.root);
    expect_refused(d, why);
  };
  refuse("texture 0: image 3 is out of range", [](json& r) { r["textures"][0]["source"] = 3; });
  refuse("picture", [](json& r) { r["images"][0]["uri"] = "missing.png"; });
  refuse("", [](json& r) { r["images"][0]["uri"] = "scene.gltf"; });
  refuse("sampler 2 is out of range", [](json& r) { r["textures"][0]["sampler"] = 2; });
  refuse("material 0: normalTexture: texture 9", [](json& r) {
    r["materials"][0]["normalTexture"] = {{"index", 9}};
  });
  refuse("alphaCutoff is -1, must be", [](json& r) {
    r["materials"][0]["alphaMode"] = "MASK";
    r["materials"][0]["alphaCutoff"] = -1;
  });
  refuse("emissiveFactor", [](json& r) { r["materials"][0]["emissiveFactor"] = {-1, 0, 0}; });
  refuse("offset must be two numbers", [](json& r) {
    r["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {
        {"offset", 1}};
  });
  refuse("requires the extension KHR_materials_unlit",
         [](json& r) { r["extensionsRequired"] = {"KHR_materials_unlit"}; });
}

TEST(GltfMesh, SparseAccessorsReplaceElementsOfZerosOrOfTheirBuffer) {
  for (const bool on_zeros : {false, true}) {
    Document d = triangle();
    const int indices = d.add<std::uint16_t>({1, 2}, "SCALAR", 5123, 1);
    const int values = d.add<float>({2, 0, 0, 0, 3, 0}, "VEC3", 5126, 3);
    json& accessor = d.root["accessors"][0];
    if (on_zeros) accessor.erase("bufferView");
    accessor["sparse"] = {{"count", 2},
                          {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                          {"values", {{"bufferView", values}}}};
    const auto scene = read(d);
    ASSERT_TRUE(scene.ok()) << scene.error().message;
    EXPECT_EQ(scene->vertices[scene->indices[1]].position, Vec3f(2, 0, 0));
    EXPECT_EQ(scene->vertices[scene->indices[2]].position, Vec3f(0, 3, 0));
    json& sparse = accessor["sparse"];
    sparse["count"] = 4;
    expect_refused(d, "sparse: 4 of 3 elements");
    sparse["count"] = 2;
    sparse["values"]["byteOffset"] = 4;
    expect_refused(d, "sparse values: 2 elements at byte 4 do not lie inside");
    sparse["values"].erase("byteOffset");
    sparse["indices"]["bufferView"] = values;
    expect_refused(d, "sparse index");
  }
}

TEST(GltfMesh, QuantisedAttributesAreThoseNumbers) {
  Document d = triangle();
  d.root["extensionsRequired"] = {"KHR_mesh_quantization"};
  const int positions = d.add<std::int16_t>({0, 0, 0, 0, 32767, 0, 0, 0, 0, -32767, 0, 0}, "VEC3", 5122, 4);
  d.root["accessors"][static_cast<std::size_t>(positions)]["normalized"] = true;
  d.root["bufferViews"][static_cast<std::size_t>(positions)]["byteStride"] = 8;
  const int normals = d.add<std::int8_t>({0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0}, "VEC3", 5120, 4);
  d.root["accessors"][static_cast<std::size_t>(normals)]["normalized"] = true;
  d.root["bufferViews"][static_cast<std::size_t>(normals)]["byteStride"] = 4;
  d.primitive()["attributes"] = {{"POSITION", positions}, {"NORMAL", normals}};
  const auto scene = read(d);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  EXPECT_EQ(scene->vertices[scene->indices[1]].position, Vec3f(1, 0, 0));
  EXPECT_EQ(scene->vertices[scene->indices[2]].position, Vec3f(0, -1, 0));
  EXPECT_EQ(scene->vertices[0].normal, Vec3f::UnitZ());
}

}  // namespace
}  // namespace lightwell::render
