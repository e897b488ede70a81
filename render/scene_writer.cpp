// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/scene_writer.h"

#include <Eigen/Geometry>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "interface/base64.h"

namespace lightwell::render {
namespace {

using nlohmann::json;

json list(const Rgb& c) {
  return json::array({c[0], c[1], c[2]});
}
json list(const Vec3f& v) {
  return json::array({v[0], v[1], v[2]});
}

json material_json(const std::string& name, const Material& material) {
  const bool phong = material.model == Material::Model::phong;
  json base = list(material.base_color);
  base.push_back(1);
  json out = {{"name", name},
              {"pbrMetallicRoughness",
               {{"baseColorFactor", base},
                {"metallicFactor", phong ? 0 : material.metallic},
                {"roughnessFactor", phong ? 0.5f : material.roughness}}}};
  if (phong)
    out["extras"] = {{"phong",
                      {{"diffuse", list(material.base_color)},
                       {"specular", list(material.specular)},
                       {"exponent", material.exponent}}}};
  return out;
}

// One buffer and the accessors into it.
class BufferWriter {
 public:
  int accessor(const void* data, std::size_t bytes, std::size_t count, const char* type, int component,
               int target) {
    views_.push_back(
        {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes}, {"target", target}});
    accessors_.push_back(
        {{"bufferView", views_.size() - 1}, {"componentType", component}, {"count", count}, {"type", type}});
    const auto* begin = static_cast<const unsigned char*>(data);
    bytes_.insert(bytes_.end(), begin, begin + bytes);
    return static_cast<int>(accessors_.size()) - 1;
  }

  json primitive(const Mesh& mesh, std::size_t material) {
    Vec3f low = mesh.positions[0];
    Vec3f high = mesh.positions[0];
    for (const Vec3f& p : mesh.positions) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const auto points = mesh.positions.size();
    const int position = accessor(mesh.positions.data(), points * sizeof(Vec3f), points, "VEC3", 5126, 34962);
    accessors_.back()["min"] = list(low);
    accessors_.back()["max"] = list(high);
    const int normal = accessor(mesh.normals.data(), points * sizeof(Vec3f), points, "VEC3", 5126, 34962);
    const int index =
        accessor(mesh.indices.data(), mesh.indices.size() * 4, mesh.indices.size(), "SCALAR", 5125, 34963);
    return {{"attributes", {{"POSITION", position}, {"NORMAL", normal}}},
            {"indices", index},
            {"material", material}};
  }

  void finish(json& root) const {
    root["bufferViews"] = views_;
    root["accessors"] = accessors_;
    root["buffers"] = json::array({{{"byteLength", bytes_.size()},
                                    {"uri", "data:application/octet-stream;base64," +
                                                base64_encode(std::as_bytes(std::span(bytes_)))}}});
  }

 private:
  std::vector<unsigned char> bytes_;
  json views_ = json::array();
  json accessors_ = json::array();
};

}  // namespace

void SceneWriter::add(const std::string& name, Mesh mesh, const std::string& material_name,
                      const Material& material, bool casts_shadow) {
  parts_.push_back({name, std::move(mesh), material_name, material, casts_shadow});
}

std::string SceneWriter::gltf(const SceneCamera& camera) const {
  json root = {{"asset", {{"version", "2.0"}, {"generator", "lightwell"}}},
               {"materials", json::array()},
               {"meshes", json::array()},
               {"nodes", json::array()},
               {"scene", 0}};
  BufferWriter buffer;
  json roots = json::array();
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Part& part = parts_[i];
    root["materials"].push_back(material_json(part.material_name, part.material));
    root["meshes"].push_back(
        {{"name", part.name}, {"primitives", json::array({buffer.primitive(part.mesh, i)})}});
    json node = {{"name", part.name}, {"mesh", i}};
    if (!part.casts_shadow) node["extras"] = {{"lightwell", {{"casts_shadow", false}}}};
    root["nodes"].push_back(node);
    roots.push_back(i);
  }
  json perspective = {{"yfov", camera.yfov_rad}, {"znear", camera.near_m}};
  if (std::isfinite(camera.far_m)) perspective["zfar"] = camera.far_m;
  if (camera.aspect > 0) perspective["aspectRatio"] = camera.aspect;
  root["cameras"] =
      json::array({{{"name", camera.name}, {"type", "perspective"}, {"perspective", perspective}}});
  json matrix = json::array();
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) matrix.push_back(camera.world_from_camera(row, column));
  root["nodes"].push_back({{"name", camera.node_name}, {"camera", 0}, {"matrix", matrix}});
  roots.push_back(parts_.size());
  root["scenes"] = json::array({{{"nodes", roots}}});
  buffer.finish(root);
  return root.dump();
}

Material phong_material(const Rgb& diffuse, const Rgb& specular, float exponent) {
  Material material;
  material.model = Material::Model::phong;
  material.base_color = diffuse;
  material.specular = specular;
  material.exponent = exponent;
  return material;
}

SceneCamera camera_at(const std::string& name, const Vec3f& eye, const Vec3f& target, float yfov_rad) {
  SceneCamera camera;
  camera.name = name;
  camera.node_name = name + " camera";
  camera.yfov_rad = yfov_rad;
  camera.far_m = 50;
  const Vec3f back = (eye - target).normalized();
  const Vec3f right = Vec3f::UnitY().cross(back).normalized();
  camera.world_from_camera.col(0).head<3>() = right;
  camera.world_from_camera.col(1).head<3>() = back.cross(right);
  camera.world_from_camera.col(2).head<3>() = back;
  camera.world_from_camera.col(3).head<3>() = eye;
  return camera;
}

}  // namespace lightwell::render
