// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/gltf_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "render/gltf_accessor.h"
#include "render/gltf_rig.h"

namespace lightwell::render::gltf {
namespace {

// count vectors of an attribute; none where the primitive has no such attribute.
template <class Vector>
std::vector<Vector> read_vectors(const tinygltf::Model& model, const tinygltf::Primitive& source,
                                 const std::string& name, std::size_t count, const std::string& what) {
  constexpr int kComponents = Vector::RowsAtCompileTime;
  const auto found = source.attributes.find(name);
  if (found == source.attributes.end()) return {};
  const auto values = take(read_floats(model, found->second, kComponents, what + " " + name));
  std::vector<Vector> vectors(values.size() / kComponents);
  if (count > 0 && vectors.size() != count)
    throw BadScene{what + ": " + name + " and POSITION differ in count"};
  for (std::size_t i = 0; i < vectors.size(); ++i)
    vectors[i] = Eigen::Map<const Vector>(&values[kComponents * i]);
  return vectors;
}

std::vector<std::array<std::uint16_t, 4>> read_colors(const tinygltf::Model& model,
                                                      const tinygltf::Primitive& source, std::size_t count,
                                                      const std::string& what) {
  const auto found = source.attributes.find("COLOR_0");
  if (found == source.attributes.end()) return {};
  const int accessor = found->second;
  // Three components or four; what is neither is refused as not four.
  const bool three = accessor >= 0 && static_cast<std::size_t>(accessor) < model.accessors.size() &&
                     model.accessors[static_cast<std::size_t>(accessor)].type == TINYGLTF_TYPE_VEC3;
  const std::size_t width = three ? 3 : 4;
  const auto values = take(read_floats(model, accessor, static_cast<int>(width), what + " COLOR_0"));
  if (values.size() != width * count) throw BadScene{what + ": COLOR_0 and POSITION differ in count"};
  std::vector<std::array<std::uint16_t, 4>> colors(count, {65535, 65535, 65535, 65535});
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t c = 0; c < width; ++c)
      colors[i][c] =
          static_cast<std::uint16_t>(std::lround(std::clamp(values[width * i + c], 0.0f, 1.0f) * 65535));
  return colors;
}

std::vector<std::uint32_t> triangle_list(std::vector<std::uint32_t> order, int mode) {
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    order.resize(order.size() - order.size() % 3);
    return order;
  }
  std::vector<std::uint32_t> list;
  for (std::size_t i = 0; i + 2 < order.size(); ++i) {
    const bool strip = mode == TINYGLTF_MODE_TRIANGLE_STRIP;
    const std::uint32_t a = strip ? order[i] : order[0];
    const std::uint32_t b = strip ? order[i + 1 + i % 2] : order[i + 1];
    const std::uint32_t c = strip ? order[i + 2 - i % 2] : order[i + 2];
    list.insert(list.end(), {a, b, c});
  }
  return list;
}

int mode_of(int mode) {
  return mode < 0 ? TINYGLTF_MODE_TRIANGLES : mode;
}

}  // namespace

const char* mode_without_triangles(int mode) {
  switch (mode_of(mode)) {
    case TINYGLTF_MODE_TRIANGLES:
    case TINYGLTF_MODE_TRIANGLE_STRIP:
    case TINYGLTF_MODE_TRIANGLE_FAN:
      return nullptr;
    case TINYGLTF_MODE_POINTS:
      return "points";
    case TINYGLTF_MODE_LINE:
      return "lines";
    case TINYGLTF_MODE_LINE_LOOP:
      return "line loop";
    case TINYGLTF_MODE_LINE_STRIP:
      return "line strip";
    default:
      return "unknown";
  }
}

MeshFromFile read_mesh(const tinygltf::Model& model, const tinygltf::Primitive& source, int uv_set,
                       const std::string& what) {
  if (!source.attributes.contains("POSITION")) throw BadScene{what + " has no POSITION"};
  MeshFromFile mesh;
  mesh.shape.positions = read_vectors<Vec3f>(model, source, "POSITION", 0, what);
  const std::size_t count = mesh.shape.positions.size();
  mesh.shape.normals = read_vectors<Vec3f>(model, source, "NORMAL", count, what);
  mesh.shape.normals.resize(count, Vec3f::Zero());
  mesh.uvs = read_vectors<Vec2f>(model, source, "TEXCOORD_" + std::to_string(uv_set), count, what);
  mesh.colors = read_colors(model, source, count, what);
  mesh.shape.targets = read_targets(model, source, count, what);
  std::vector<std::uint32_t> order;
  if (source.indices >= 0) {
    order = take(read_indices(model, source.indices, count, what + " indices"));
  } else {
    order.resize(count);
    std::iota(order.begin(), order.end(), 0u);
  }
  mesh.triangles = triangle_list(std::move(order), mode_of(source.mode));
  return mesh;
}

}  // namespace lightwell::render::gltf
