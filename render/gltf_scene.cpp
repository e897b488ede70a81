// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/gltf_scene.h"

#include <tiny_gltf.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "interface/atomic_file.h"
#include "render/gltf_accessor.h"

namespace lightwell::render {
namespace {

using tinygltf::Value;

// Deeper than any real scene; a cycle of nodes stops here too.
constexpr int kMaxDepth = 256;

const Value* member(const Value& object, const char* key) {
  return object.IsObject() && object.Has(key) ? &object.Get(key) : nullptr;
}

// Thrown inside this file only, caught in read_gltf.
struct BadScene {
  std::string message;
};

float number(const Value& value, const std::string& what, double low, double high) {
  const double x = value.IsNumber() ? value.GetNumberAsDouble() : std::nan("");
  if (!(x >= low && x <= high))
    throw BadScene{what + " must be a number from " + std::to_string(low) + " to " + std::to_string(high)};
  return static_cast<float>(x);
}

Rgb colour(const Value& value, const std::string& what) {
  if (!value.IsArray() || value.ArrayLen() != 3) throw BadScene{what + " must be three numbers"};
  Rgb c;
  for (int i = 0; i < 3; ++i) c[i] = number(value.Get(i), what, 0, 1e6);
  return c;
}

class Reader {
 public:
  explicit Reader(const tinygltf::Model& model) : model_(model) {}

  Scene read() {
    if (!model_.extensionsRequired.empty())
      throw BadScene{"requires the extension " + model_.extensionsRequired.front() +
                     ", which is not supported"};
    read_textures();
    for (std::size_t i = 0; i < model_.materials.size(); ++i) scene_.materials.push_back(material(i));
    const Mat4f identity = Mat4f::Identity();
    for (const int node : roots()) visit(node, identity, true, 0);
    if (scene_.indices.empty()) throw BadScene{"has no triangles with an area"};
    return std::move(scene_);
  }

 private:
  [[nodiscard]] std::vector<int> roots() const {
    if (!model_.scenes.empty()) {
      const int chosen = model_.defaultScene < 0 ? 0 : model_.defaultScene;
      if (static_cast<std::size_t>(chosen) >= model_.scenes.size())
        throw BadScene{"scene " + std::to_string(chosen) + " is out of range"};
      return model_.scenes[static_cast<std::size_t>(chosen)].nodes;
    }
    std::set<int> children;
    for (const auto& node : model_.nodes) children.insert(node.children.begin(), node.children.end());
    std::vector<int> result;
    for (int i = 0; i < static_cast<int>(model_.nodes.size()); ++i)
      if (!children.contains(i)) result.push_back(i);
    return result;
  }

  void read_textures() {
    for (std::size_t i = 0; i < model_.textures.size(); ++i) {
      const int source = model_.textures[i].source;
      if (source < 0 || static_cast<std::size_t>(source) >= model_.images.size())
        throw BadScene{"texture " + std::to_string(i) + " names image " + std::to_string(source) +
                       ", out of range"};
      const tinygltf::Image& image = model_.images[static_cast<std::size_t>(source)];
      const auto bytes = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 4;
      if (image.width <= 0 || image.height <= 0 || image.component != 4 || image.bits != 8 ||
          image.image.size() != bytes)
        throw BadScene{"image " + std::to_string(source) + " is not a readable 8 bit picture"};
      scene_.textures.push_back({image.width, image.height, image.image});
    }
  }

  int texture(const tinygltf::TextureInfo& info, const std::string& what) const {
    if (info.index < 0) return -1;
    if (static_cast<std::size_t>(info.index) >= scene_.textures.size())
      throw BadScene{what + " names texture " + std::to_string(info.index) + ", out of range"};
    if (info.texCoord != 0)
      throw BadScene{what + " uses TEXCOORD_" + std::to_string(info.texCoord) + ", only 0 is supported"};
    return info.index;
  }

  Material material(std::size_t i) const {
    const tinygltf::Material& source = model_.materials[i];
    const std::string what = "material " + std::to_string(i);
    const auto& pbr = source.pbrMetallicRoughness;
    Material m;
    if (pbr.baseColorFactor.size() != 4) throw BadScene{what + ": baseColorFactor must be four numbers"};
    for (int c = 0; c < 3; ++c)
      m.base_color[c] =
          number(Value(pbr.baseColorFactor[static_cast<std::size_t>(c)]), what + ": baseColorFactor", 0, 1);
    m.metallic = number(Value(pbr.metallicFactor), what + ": metallicFactor", 0, 1);
    m.roughness = number(Value(pbr.roughnessFactor), what + ": roughnessFactor", 0, 1);
    m.base_color_texture = texture(pbr.baseColorTexture, what + ": baseColorTexture");
    tinygltf::TextureInfo rough;
    rough.index = pbr.metallicRoughnessTexture.index;
    rough.texCoord = pbr.metallicRoughnessTexture.texCoord;
    m.metallic_roughness_texture = texture(rough, what + ": metallicRoughnessTexture");
    m.double_sided = source.doubleSided;
    apply_phong(source.extras, what, m);
    return m;
  }

  // True where extras carries a phong model.
  static bool apply_phong(const Value& extras, const std::string& what, Material& m) {
    const Value* phong = member(extras, "phong");
    if (phong == nullptr) return false;
    if (!phong->IsObject()) throw BadScene{what + ": extras.phong must be an object"};
    m.model = Material::Model::phong;
    m.base_color = Rgb::Zero();
    if (const Value* v = member(*phong, "diffuse"))
      m.base_color = colour(*v, what + ": extras.phong.diffuse");
    if (const Value* v = member(*phong, "specular"))
      m.specular = colour(*v, what + ": extras.phong.specular");
    if (const Value* v = member(*phong, "exponent"))
      m.exponent = number(*v, what + ": extras.phong.exponent", 0, 1e6);
    return true;
  }

  void visit(int index, const Mat4f& world_from_parent, bool casts, int depth) {
    if (index < 0 || static_cast<std::size_t>(index) >= model_.nodes.size())
      throw BadScene{"node " + std::to_string(index) + " is out of range"};
    if (depth > kMaxDepth)
      throw BadScene{"nodes are nested deeper than " + std::to_string(kMaxDepth) + " or in a circle"};
    const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(index)];
    const std::string what = "node " + std::to_string(index);
    const Mat4f world_from_node = world_from_parent * transform(node, what);
    if (!world_from_node.allFinite()) throw BadScene{what + ": transform is not finite"};
    if (const Value* ours = member(node.extras, "lightwell"))
      if (const Value* flag = member(*ours, "casts_shadow")) {
        if (!flag->IsBool()) throw BadScene{what + ": extras.lightwell.casts_shadow must be true or false"};
        casts = flag->Get<bool>();
      }
    if (node.camera >= 0) add_camera(node, world_from_node, what);
    if (node.mesh >= 0) add_mesh(node, world_from_node, casts, what);
    for (const int child : node.children) visit(child, world_from_node, casts, depth + 1);
  }

  static Mat4f transform(const tinygltf::Node& node, const std::string& what) {
    const auto check = [&](const std::vector<double>& v, std::size_t n, const char* key) {
      if (!v.empty() && v.size() != n)
        throw BadScene{what + ": " + key + " must be " + std::to_string(n) + " numbers"};
    };
    check(node.matrix, 16, "matrix");
    check(node.translation, 3, "translation");
    check(node.rotation, 4, "rotation");
    check(node.scale, 3, "scale");
    if (!node.matrix.empty()) return Eigen::Map<const Eigen::Matrix4d>(node.matrix.data()).cast<float>();
    Eigen::Affine3d t = Eigen::Affine3d::Identity();
    if (!node.translation.empty()) t.translate(Eigen::Map<const Vec3d>(node.translation.data()));
    if (!node.rotation.empty()) {
      const Eigen::Quaterniond q(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
      if (!(q.norm() > 0)) throw BadScene{what + ": rotation must be a unit quaternion"};
      t.rotate(q.normalized());
    }
    if (!node.scale.empty()) t.scale(Eigen::Map<const Vec3d>(node.scale.data()));
    return t.matrix().cast<float>();
  }

  void add_camera(const tinygltf::Node& node, const Mat4f& world_from_node, const std::string& what) {
    if (static_cast<std::size_t>(node.camera) >= model_.cameras.size())
      throw BadScene{what + ": camera " + std::to_string(node.camera) + " is out of range"};
    const tinygltf::Camera& source = model_.cameras[static_cast<std::size_t>(node.camera)];
    if (source.type != "perspective") return;
    const auto& p = source.perspective;
    SceneCamera camera;
    camera.name = source.name;
    camera.node_name = node.name;
    camera.yfov_rad = number(Value(p.yfov), "camera '" + source.name + "': yfov", 1e-3, kPi - 1e-3);
    camera.near_m = number(Value(p.znear), "camera '" + source.name + "': znear", 1e-9, 1e9);
    if (p.zfar > 0) camera.far_m = static_cast<float>(p.zfar);
    if (!(camera.far_m > camera.near_m))
      throw BadScene{"camera '" + source.name + "': zfar must be beyond znear"};
    if (p.aspectRatio != 0)
      camera.aspect = number(Value(p.aspectRatio), "camera '" + source.name + "': aspectRatio", 1e-3, 1e3);
    // A camera looks along its node's axes; scale does not zoom (glTF 2.0, 3.10.2).
    camera.world_from_camera = world_from_node;
    for (int c = 0; c < 3; ++c) {
      auto axis = camera.world_from_camera.col(c).head<3>();
      if (!(axis.norm() > 0)) throw BadScene{what + ": a camera's axes must not be scaled to 0"};
      axis.normalize();
    }
    scene_.cameras.push_back(camera);
  }

  void add_mesh(const tinygltf::Node& node, const Mat4f& world_from_node, bool casts,
                const std::string& what) {
    if (static_cast<std::size_t>(node.mesh) >= model_.meshes.size())
      throw BadScene{what + ": mesh " + std::to_string(node.mesh) + " is out of range"};
    const tinygltf::Mesh& mesh = model_.meshes[static_cast<std::size_t>(node.mesh)];
    for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
      const std::string name = "mesh " + std::to_string(node.mesh) + " primitive " + std::to_string(p);
      const tinygltf::Primitive& source = mesh.primitives[p];
      const int mode = source.mode < 0 ? TINYGLTF_MODE_TRIANGLES : source.mode;
      if (mode < TINYGLTF_MODE_TRIANGLES || mode > TINYGLTF_MODE_TRIANGLE_FAN) {
        leave_out(name + ": mode " + std::to_string(mode) + " (" + mode_name(mode) + ")");
        continue;
      }
      Primitive primitive;
      primitive.casts_shadow = casts;
      primitive.material = primitive_material(node, mesh, source, name);
      add_triangles(source, mode, world_from_node, name, primitive);
      if (primitive.index_count > 0) scene_.primitives.push_back(primitive);
    }
  }

  // A mesh that several nodes show is said once.
  void leave_out(std::string what) {
    auto& list = scene_.left_out;
    if (std::find(list.begin(), list.end(), what) == list.end()) list.push_back(std::move(what));
  }

  static const char* mode_name(int mode) {
    switch (mode) {
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

  // Its own copy of the material where the primitive, mesh or node carries extras.phong.
  int primitive_material(const tinygltf::Node& node, const tinygltf::Mesh& mesh,
                         const tinygltf::Primitive& source, const std::string& what) {
    Material m;
    if (source.material >= 0) {
      if (static_cast<std::size_t>(source.material) >= model_.materials.size())
        throw BadScene{what + ": material " + std::to_string(source.material) + " is out of range"};
      m = scene_.materials[static_cast<std::size_t>(source.material)];
      if (m.model == Material::Model::phong) return source.material;
    }
    const bool phong = apply_phong(source.extras, what, m) || apply_phong(mesh.extras, what, m) ||
                       apply_phong(node.extras, what, m);
    if (!phong && source.material >= 0) return source.material;
    scene_.materials.push_back(m);
    return static_cast<int>(scene_.materials.size()) - 1;
  }

  static std::vector<float> take(Result<std::vector<float>> values) {
    if (!values) throw BadScene{values.error().message};
    return std::move(values).value();
  }

  void add_triangles(const tinygltf::Primitive& source, int mode, const Mat4f& world_from_node,
                     const std::string& what, Primitive& primitive) {
    const auto attribute = [&](const char* name) {
      const auto found = source.attributes.find(name);
      return found == source.attributes.end() ? -1 : found->second;
    };
    if (attribute("POSITION") < 0) throw BadScene{what + " has no POSITION"};
    const auto positions = take(read_floats(model_, attribute("POSITION"), 3, what + " POSITION"));
    std::vector<float> normals;
    std::vector<float> uvs;
    if (attribute("NORMAL") >= 0)
      normals = take(read_floats(model_, attribute("NORMAL"), 3, what + " NORMAL"));
    if (attribute("TEXCOORD_0") >= 0)
      uvs = take(read_floats(model_, attribute("TEXCOORD_0"), 2, what + " TEXCOORD_0"));
    const std::size_t count = positions.size() / 3;
    if (!normals.empty() && normals.size() != 3 * count)
      throw BadScene{what + ": NORMAL and POSITION differ in count"};
    if (!uvs.empty() && uvs.size() != 2 * count)
      throw BadScene{what + ": TEXCOORD_0 and POSITION differ in count"};

    const Eigen::Matrix3f linear = world_from_node.topLeftCorner<3, 3>();
    // The cofactor matrix carries normals: it is the inverse transpose times the determinant, and exists for
    // any scale.
    Eigen::Matrix3f cofactor;
    cofactor << linear.col(1).cross(linear.col(2)), linear.col(2).cross(linear.col(0)),
        linear.col(0).cross(linear.col(1));
    const bool mirrored = linear.determinant() < 0;
    if (mirrored) cofactor = -cofactor;
    std::vector<Vertex> vertices(count);
    for (std::size_t i = 0; i < count; ++i) {
      Vertex& v = vertices[i];
      v.position =
          linear * Eigen::Map<const Vec3f>(&positions[3 * i]) + world_from_node.topRightCorner<3, 1>();
      if (!v.position.allFinite()) throw BadScene{what + ": vertex " + std::to_string(i) + " is not finite"};
      v.normal = normals.empty() ? Vec3f::Zero() : Vec3f(cofactor * Eigen::Map<const Vec3f>(&normals[3 * i]));
      const float length = v.normal.norm();
      v.normal = length > 0 && std::isfinite(length) ? Vec3f(v.normal / length) : Vec3f::Zero();
      if (!uvs.empty()) v.uv = Eigen::Map<const Vec2f>(&uvs[2 * i]);
    }
    std::vector<std::uint32_t> order;
    if (source.indices >= 0) {
      auto indices = read_indices(model_, source.indices, count, what + " indices");
      if (!indices) throw BadScene{indices.error().message};
      order = std::move(indices).value();
    } else {
      for (std::size_t i = 0; i < count; ++i) order.push_back(static_cast<std::uint32_t>(i));
    }
    append(vertices, triangle_list(order, mode), mirrored, primitive);
  }

  static std::vector<std::uint32_t> triangle_list(const std::vector<std::uint32_t>& order, int mode) {
    std::vector<std::uint32_t> list;
    if (mode == TINYGLTF_MODE_TRIANGLES) {
      list.assign(order.begin(), order.end() - static_cast<std::ptrdiff_t>(order.size() % 3));
      return list;
    }
    for (std::size_t i = 0; i + 2 < order.size(); ++i) {
      const bool strip = mode == TINYGLTF_MODE_TRIANGLE_STRIP;
      const std::uint32_t a = strip ? order[i] : order[0];
      const std::uint32_t b = strip ? order[i + 1 + i % 2] : order[i + 1];
      const std::uint32_t c = strip ? order[i + 2 - i % 2] : order[i + 2];
      list.insert(list.end(), {a, b, c});
    }
    return list;
  }

  // Drops triangles of no area; corners without a normal get the triangle's.
  void append(const std::vector<Vertex>& vertices, const std::vector<std::uint32_t>& list, bool mirrored,
              Primitive& primitive) {
    const auto base = static_cast<std::uint32_t>(scene_.vertices.size());
    primitive.first_index = static_cast<std::uint32_t>(scene_.indices.size());
    scene_.vertices.insert(scene_.vertices.end(), vertices.begin(), vertices.end());
    for (std::size_t t = 0; t + 2 < list.size(); t += 3) {
      std::uint32_t corner[3] = {list[t], list[t + 1], list[t + 2]};
      if (mirrored) std::swap(corner[1], corner[2]);
      const Vec3d a = vertices[corner[0]].position.cast<double>();
      const Vec3d cross = (vertices[corner[1]].position.cast<double>() - a)
                              .cross(vertices[corner[2]].position.cast<double>() - a);
      if (!(cross.norm() > 0)) {
        ++scene_.dropped_triangles;
        continue;
      }
      for (const std::uint32_t c : corner) {
        if (vertices[c].normal.isZero()) {
          scene_.indices.push_back(static_cast<std::uint32_t>(scene_.vertices.size()));
          scene_.vertices.push_back({vertices[c].position, cross.normalized().cast<float>(), vertices[c].uv});
        } else {
          scene_.indices.push_back(base + c);
        }
      }
    }
    primitive.index_count = static_cast<std::uint32_t>(scene_.indices.size()) - primitive.first_index;
  }

  const tinygltf::Model& model_;
  Scene scene_;
};

std::string one_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  for (char& c : text)
    if (c == '\n' || c == '\r') c = ' ';
  return text.empty() ? "is not glTF 2.0" : text;
}

}  // namespace

Result<Scene> read_gltf(const std::filesystem::path& file) {
  const auto bad = [&](const std::string& why) {
    return Error{ErrorKind::bad_input, file.string() + ": " + why};
  };
  const auto text = read_text_file(file);
  if (!text) return text.error();
  tinygltf::Model model;
  try {
    tinygltf::TinyGLTF loader;
    std::string error;
    std::string warning;
    const std::string folder = file.has_parent_path() ? file.parent_path().string() : ".";
    const auto length = static_cast<unsigned int>(text->size());
    const bool binary = text->starts_with("glTF");
    const bool read =
        binary ? loader.LoadBinaryFromMemory(&model, &error, &warning,
                                             reinterpret_cast<const unsigned char*>(text->data()), length,
                                             folder)
               : loader.LoadASCIIFromString(&model, &error, &warning, text->c_str(), length, folder);
    if (!read || !error.empty()) return bad(one_line(error));
    return Reader(model).read();
  } catch (const BadScene& e) {
    return bad(e.message);
  } catch (const std::exception& e) {
    return bad(one_line(e.what()));
  }
}

}  // namespace lightwell::render
