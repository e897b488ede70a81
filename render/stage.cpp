// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/stage.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "interface/base64.h"
#include "lighting/vector.h"

namespace lightwell::render {
namespace {

using nlohmann::json;

struct Mesh {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;
  std::vector<std::uint32_t> indices;

  std::uint32_t add(const Vec3f& position, const Vec3f& normal) {
    positions.push_back(position);
    normals.push_back(normal.normalized());
    return static_cast<std::uint32_t>(positions.size()) - 1;
  }
  void quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    indices.insert(indices.end(), {a, b, c, a, c, d});
  }
};

float turn(int i, int count) {
  return static_cast<float>(2 * kPi * (i % count) / count);
}

Mesh ground(float half_side) {
  Mesh m;
  for (const auto& [x, z] : {std::pair(-1, -1), std::pair(-1, 1), std::pair(1, 1), std::pair(1, -1)})
    m.add(Vec3f(static_cast<float>(x), 0, static_cast<float>(z)) * half_side, Vec3f::UnitY());
  m.quad(0, 1, 2, 3);
  return m;
}

Mesh sphere(const Vec3f& centre, float radius, int rings, int sectors) {
  Mesh m;
  const auto s = static_cast<std::uint32_t>(sectors);
  m.add(centre + radius * Vec3f::UnitY(), Vec3f::UnitY());
  for (int r = 1; r < rings; ++r)
    for (int i = 0; i < sectors; ++i) {
      const float theta = static_cast<float>(kPi * r / rings);
      const Vec3f n(std::sin(theta) * std::sin(turn(i, sectors)), std::cos(theta),
                    std::sin(theta) * std::cos(turn(i, sectors)));
      m.add(centre + radius * n, n);
    }
  const std::uint32_t south = m.add(centre - radius * Vec3f::UnitY(), -Vec3f::UnitY());
  for (std::uint32_t i = 0; i < s; ++i) {
    const std::uint32_t next = (i + 1) % s;
    m.indices.insert(m.indices.end(), {0, 1 + i, 1 + next});
    for (std::uint32_t r = 0; r + 2 < static_cast<std::uint32_t>(rings); ++r)
      m.quad(1 + r * s + i, 1 + (r + 1) * s + i, 1 + (r + 1) * s + next, 1 + r * s + next);
    m.indices.insert(m.indices.end(), {south, south - s + next, south - s + i});
  }
  return m;
}

// Closed cylinder from one point to another.
void add_bar(Mesh& m, const Vec3f& from, const Vec3f& to, float radius, int sides) {
  const Vec3f axis = (to - from).normalized();
  const Vec3f u = axis.unitOrthogonal();
  const Vec3f v = axis.cross(u);
  const auto base = static_cast<std::uint32_t>(m.positions.size());
  for (int i = 0; i < sides; ++i) {
    const Vec3f n = std::cos(turn(i, sides)) * u + std::sin(turn(i, sides)) * v;
    for (const bool side : {true, false}) {  // one corner for the side, one for the cap
      m.add(from + radius * n, side ? n : Vec3f(-axis));
      m.add(to + radius * n, side ? n : axis);
    }
  }
  const std::uint32_t bottom = m.add(from, -axis);
  const std::uint32_t top = m.add(to, axis);
  for (int i = 0; i < sides; ++i) {
    const std::uint32_t a = base + 4 * static_cast<std::uint32_t>(i);
    const std::uint32_t b = base + 4 * static_cast<std::uint32_t>((i + 1) % sides);
    m.quad(a, b, b + 1, a + 1);
    m.indices.insert(m.indices.end(), {bottom, b + 2, a + 2, top, a + 3, b + 3});
  }
}

// A tube along the (2,3) torus knot, standing upright.
Mesh knot(const Vec3f& centre, float size, float tube, int steps, int sides) {
  Mesh m;
  const auto curve = [&](int i) {
    const double t = 2 * kPi * (i % steps) / steps;
    const double r = 2 + std::cos(3 * t);
    return Vec3d(r * std::cos(2 * t), r * std::sin(2 * t), std::sin(3 * t));
  };
  for (int i = 0; i < steps; ++i) {
    const Vec3d p = curve(i);
    const Vec3d tangent = (curve(i + 1) - curve(i + steps - 1)).normalized();
    const Vec3d across = tangent.cross(p).normalized();
    const Vec3d out = across.cross(tangent);
    for (int k = 0; k < sides; ++k) {
      const double a = 2 * kPi * k / sides;
      const Vec3f n = (std::cos(a) * out + std::sin(a) * across).cast<float>();
      m.add(centre + size * p.cast<float>() + tube * n, n);
    }
  }
  const auto s = static_cast<std::uint32_t>(sides);
  const auto n = static_cast<std::uint32_t>(steps);
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t k = 0; k < s; ++k) {
      const std::uint32_t i2 = (i + 1) % n;
      const std::uint32_t k2 = (k + 1) % s;
      m.quad(i * s + k, i * s + k2, i2 * s + k2, i2 * s + k);
    }
  return m;
}

Mesh railing() {
  Mesh m;
  constexpr int kPoles = 10;
  for (int i = 0; i < kPoles; ++i) {
    const float x = -1.35f + 0.3f * static_cast<float>(i);
    add_bar(m, {x, 0, -0.95f}, {x, 0.9f, -0.95f}, 0.015f, 12);
  }
  for (const float y : {0.2f, 0.4f, 0.6f, 0.8f})
    add_bar(m, {-1.5f, y, -0.95f}, {1.5f, y, -0.95f}, 0.011f, 12);
  return m;
}

// Collects meshes into one buffer and the JSON that describes it.
class Writer {
 public:
  void add(const char* name, const Mesh& mesh, const json& material, bool casts_shadow) {
    Vec3f low = mesh.positions[0];
    Vec3f high = mesh.positions[0];
    for (const Vec3f& p : mesh.positions) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const auto points = mesh.positions.size();
    const int position = accessor(mesh.positions.data(), points * sizeof(Vec3f), points, "VEC3", 5126, 34962);
    root_["accessors"].back()["min"] = {low.x(), low.y(), low.z()};
    root_["accessors"].back()["max"] = {high.x(), high.y(), high.z()};
    const int normal = accessor(mesh.normals.data(), points * sizeof(Vec3f), points, "VEC3", 5126, 34962);
    const int index =
        accessor(mesh.indices.data(), mesh.indices.size() * 4, mesh.indices.size(), "SCALAR", 5125, 34963);
    const json primitive = {{"attributes", {{"POSITION", position}, {"NORMAL", normal}}},
                            {"indices", index},
                            {"material", root_["materials"].size()}};
    root_["materials"].push_back(material);
    json node = {{"name", name}, {"mesh", root_["meshes"].size()}};
    if (!casts_shadow) node["extras"] = {{"lightwell", {{"casts_shadow", false}}}};
    root_["meshes"].push_back({{"name", name}, {"primitives", json::array({primitive})}});
    root_["nodes"].push_back(node);
  }

  std::string finish(const json& camera, const json& camera_node) {
    root_["cameras"] = json::array({camera});
    root_["nodes"].push_back(camera_node);
    json nodes = json::array();
    for (std::size_t i = 0; i < root_["nodes"].size(); ++i) nodes.push_back(i);
    root_["asset"] = {{"version", "2.0"}, {"generator", "lightwell"}};
    root_["scenes"] = json::array({{{"nodes", nodes}}});
    root_["scene"] = 0;
    root_["buffers"] = json::array({{{"byteLength", bytes_.size()},
                                     {"uri", "data:application/octet-stream;base64," +
                                                 base64_encode(std::as_bytes(std::span(bytes_)))}}});
    return root_.dump();
  }

 private:
  int accessor(const void* data, std::size_t bytes, std::size_t count, const char* type, int component,
               int target) {
    root_["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes}, {"target", target}});
    root_["accessors"].push_back({{"bufferView", root_["bufferViews"].size() - 1},
                                  {"componentType", component},
                                  {"count", count},
                                  {"type", type}});
    const auto* begin = static_cast<const unsigned char*>(data);
    bytes_.insert(bytes_.end(), begin, begin + bytes);
    return static_cast<int>(root_["accessors"].size()) - 1;
  }

  std::vector<unsigned char> bytes_;
  json root_ = {{"bufferViews", json::array()},
                {"accessors", json::array()},
                {"materials", json::array()},
                {"meshes", json::array()},
                {"nodes", json::array()}};
};

json phong(const char* name, const Rgb& diffuse, const Rgb& specular, float exponent) {
  const auto list = [](const Rgb& c) { return json::array({c[0], c[1], c[2]}); };
  json base = list(diffuse);
  base.push_back(1);  // what other viewers show
  return {
      {"name", name},
      {"pbrMetallicRoughness", {{"baseColorFactor", base}, {"metallicFactor", 0}, {"roughnessFactor", 0.5}}},
      {"extras",
       {{"phong", {{"diffuse", list(diffuse)}, {"specular", list(specular)}, {"exponent", exponent}}}}}};
}

}  // namespace

std::string stage_gltf() {
  Writer writer;
  writer.add("ground", ground(6), phong("matte", {0.42f, 0.40f, 0.38f}, Rgb::Zero(), 1), false);
  writer.add("pearl", sphere({-0.85f, 0.45f, 0.35f}, 0.45f, 44, 48),
             phong("pearl", Rgb::Constant(0.6f), Rgb::Constant(0.22f), 60), true);
  Mesh pedestal;
  add_bar(pedestal, {0.55f, 0, 0}, {0.55f, 0.35f, 0}, 0.42f, 48);
  writer.add("pedestal", pedestal, phong("stone", {0.55f, 0.52f, 0.47f}, Rgb::Zero(), 1), true);
  writer.add("knot", knot({0.55f, 0.98f, 0}, 0.18f, 0.085f, 280, 20),
             phong("bronze", {0.35f, 0.16f, 0.06f}, {0.40f, 0.28f, 0.16f}, 24), true);
  writer.add("railing", railing(), phong("lacquer", {0.10f, 0.22f, 0.30f}, Rgb::Constant(0.05f), 30), true);
  // Looks from (0, 1.9, 4.6) slightly down at the group.
  const Eigen::Quaternionf rotation(Eigen::AngleAxisf(-0.26f, Vec3f::UnitX()));
  return writer.finish({{"name", "stage"},
                        {"type", "perspective"},
                        {"perspective", {{"yfov", 0.58}, {"znear", 0.1}, {"zfar", 50.0}}}},
                       {{"name", "stage camera"},
                        {"camera", 0},
                        {"translation", {0.0, 1.75, 4.6}},
                        {"rotation", {rotation.x(), rotation.y(), rotation.z(), rotation.w()}}});
}

}  // namespace lightwell::render
