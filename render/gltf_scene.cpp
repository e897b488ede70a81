// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/gltf_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <set>

#include "interface/atomic_file.h"
#include "render/gltf_materials.h"
#include "render/gltf_mesh.h"
#include "render/gltf_rig.h"
#include "render/gltf_values.h"
#include "render/scene_motion.h"

namespace lightwell::render {
namespace {

using namespace gltf;  // NOLINT(google-build-using-namespace)

// Deeper than any real scene; a cycle of nodes stops here too.
constexpr int kMaxDepth = 256;
// Nodes may show one mesh many times: a small file could ask for any number of triangles.
constexpr std::size_t kMostTriangles = 100'000'000;

class Reader {
 public:
  explicit Reader(const tinygltf::Model& model) : model_(model) {}

  Scene read(const std::string& animation) {
    check_extensions(model_, scene_.remarks);
    scene_.textures = read_textures(model_);
    for (std::size_t i = 0; i < model_.materials.size(); ++i) {
      const MaterialFromFile m = read_material(model_, i, scene_.remarks);
      scene_.materials.push_back(m.material);
      uv_sets_.push_back(m.uv_set);
    }
    places_.assign(model_.nodes.size(), -1);
    for (const int node : roots()) visit(node, -1, true, 0);
    choose_animation(animation);
    find_what_moves();
    for (std::size_t i = 0; i < model_.skins.size(); ++i)
      scene_.rig.skins.push_back(used_skins_.contains(i) ? read_skin(model_, i, places_) : Skin{});
    pose_ = scene_.rig.tracks.empty() ? rest_pose(scene_.rig) : pose_at(scene_.rig, 0);
    for (const Use& use : uses_) {
      const std::string what = "node " + std::to_string(use.source);
      if (!pose_.world_from_node[use.node].allFinite()) throw BadScene{what + ": transform is not finite"};
      const tinygltf::Node& node = model_.nodes[use.source];
      if (node.camera >= 0) add_camera(node, use.node, what);
      if (node.mesh >= 0) add_mesh(node, use, what);
    }
    if (scene_.indices.empty()) throw BadScene{"has no triangles with an area"};
    if (!scene_.rig.moves()) scene_.rig.skins = {};  // nodes and tracks stay: lamps may hang on them
    return std::move(scene_);
  }

 private:
  // A node that shows something.
  struct Use {
    std::size_t source = 0;  // of the file
    std::size_t node = 0;    // of the rig
    bool casts = true;
  };

  [[nodiscard]] std::vector<int> roots() const {
    if (!model_.scenes.empty()) {
      const int chosen = model_.defaultScene < 0 ? 0 : model_.defaultScene;
      return model_.scenes[index_in(model_.scenes.size(), chosen, "scene")].nodes;
    }
    std::set<int> children;
    for (const auto& node : model_.nodes) children.insert(node.children.begin(), node.children.end());
    std::vector<int> result;
    for (int i = 0; i < static_cast<int>(model_.nodes.size()); ++i)
      if (!children.contains(i)) result.push_back(i);
    return result;
  }

  void visit(int index, int parent, bool casts, int depth) {
    const std::size_t source = index_in(model_.nodes.size(), index, "node");
    const std::string what = "node " + std::to_string(index);
    if (depth > kMaxDepth) throw BadScene{what + ": nested deeper than " + std::to_string(kMaxDepth)};
    if (places_[source] >= 0) throw BadScene{what + " stands in the tree of nodes twice, or in a circle"};
    const tinygltf::Node& node = model_.nodes[source];
    if (const tinygltf::Value* ours = member(node.extras, "lightwell"))
      if (const tinygltf::Value* flag = member(*ours, "casts_shadow")) {
        if (!flag->IsBool()) throw BadScene{what + ": extras.lightwell.casts_shadow must be true or false"};
        casts = flag->Get<bool>();
      }
    const auto place = static_cast<int>(scene_.rig.nodes.size());
    places_[source] = place;
    RigNode& added = scene_.rig.nodes.emplace_back(read_node(node, what));
    added.parent = parent;
    std::size_t targets = 0;
    if (node.mesh >= 0) {
      const tinygltf::Mesh& mesh = model_.meshes[index_in(model_.meshes.size(), node.mesh, what + ": mesh")];
      for (const auto& p : mesh.primitives) targets = std::max(targets, p.targets.size());
      if (added.weights.empty())
        for (const double w : mesh.weights)
          added.weights.push_back(number(w, "mesh " + std::to_string(node.mesh) + ": weights", -1e6, 1e6));
      if (node.skin >= 0) used_skins_.insert(index_in(model_.skins.size(), node.skin, what + ": skin"));
    }
    added.weights.resize(targets, 0.0f);
    weight_counts_.push_back(targets);
    if (node.camera >= 0 || node.mesh >= 0) uses_.push_back({source, static_cast<std::size_t>(place), casts});
    for (const int child : node.children) visit(child, place, casts, depth + 1);
  }

  // The one of that name; without a name the first.
  void choose_animation(const std::string& name) {
    std::string names;
    std::size_t chosen = model_.animations.size();
    for (std::size_t i = 0; i < model_.animations.size(); ++i) {
      names += (i == 0 ? "'" : ", '") + model_.animations[i].name + "'";
      if (chosen == model_.animations.size() && (name.empty() || model_.animations[i].name == name))
        chosen = i;
    }
    if (chosen == model_.animations.size()) {
      if (name.empty()) return;
      throw BadScene{names.empty() ? "no animation '" + name + "', the file has none"
                                   : "no animation '" + name + "', the file has " + names,
                     ErrorKind::usage};
    }
    if (name.empty() && model_.animations.size() > 1)
      scene_.remarks.push_back("the first of its animations is shown; --animation chooses of " + names);
    read_animation(model_, chosen, places_, weight_counts_, scene_.rig);
  }

  // Which nodes an animation moves, themselves or with their parents, and which may mirror at times.
  void find_what_moves() {
    const auto& nodes = scene_.rig.nodes;
    moves_.assign(nodes.size(), false);
    may_mirror_.assign(nodes.size(), false);
    weights_move_.assign(nodes.size(), false);
    for (const Track& track : scene_.rig.tracks) {
      const bool weights = track.property == Track::Property::weights;
      (weights ? weights_move_ : moves_)[track.node] = true;
      if (track.property == Track::Property::scale &&
          *std::min_element(track.values.begin(), track.values.end()) < 0)
        may_mirror_[track.node] = true;
    }
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (nodes[i].parent < 0) continue;
      const auto parent = static_cast<std::size_t>(nodes[i].parent);
      moves_[i] = moves_[i] || moves_[parent];
      may_mirror_[i] = may_mirror_[i] || may_mirror_[parent];
    }
  }

  void add_camera(const tinygltf::Node& node, std::size_t place, const std::string& what) {
    const tinygltf::Camera& source =
        model_.cameras[index_in(model_.cameras.size(), node.camera, what + ": camera")];
    if (source.type != "perspective") {
      scene_.remarks.push_back("camera '" + source.name + "' is not a perspective one and is passed by");
      return;
    }
    const auto& p = source.perspective;
    SceneCamera camera;
    camera.name = source.name;
    camera.node_name = node.name;
    camera.yfov_rad = number(p.yfov, "camera '" + source.name + "': yfov", 1e-3, kPi - 1e-3);
    camera.near_m = number(p.znear, "camera '" + source.name + "': znear", 1e-9, 1e9);
    if (p.zfar > 0) camera.far_m = static_cast<float>(p.zfar);
    if (!(camera.far_m > camera.near_m))
      throw BadScene{"camera '" + source.name + "': zfar must be beyond znear"};
    if (p.aspectRatio != 0)
      camera.aspect = number(p.aspectRatio, "camera '" + source.name + "': aspectRatio", 1e-3, 1e3);
    camera.world_from_camera = camera_at_node(pose_.world_from_node[place]);
    if (!camera.world_from_camera.allFinite())
      throw BadScene{what + ": a camera's axes must not be scaled to 0"};
    if (moves_[place]) scene_.rig.cameras.push_back({scene_.cameras.size(), place});
    scene_.cameras.push_back(camera);
  }

  void add_mesh(const tinygltf::Node& node, const Use& use, const std::string& what) {
    const tinygltf::Mesh& mesh = model_.meshes[index_in(model_.meshes.size(), node.mesh, what + ": mesh")];
    for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
      const std::string name = "mesh " + std::to_string(node.mesh) + " primitive " + std::to_string(p);
      const tinygltf::Primitive& source = mesh.primitives[p];
      if (const char* mode = mode_without_triangles(source.mode)) {
        leave_out(name + ": mode " + std::to_string(source.mode) + " (" + mode + ")");
        continue;
      }
      Primitive primitive;
      primitive.casts_shadow = use.casts;
      primitive.material = primitive_material(node, mesh, source, name);
      MeshFromFile from_file = read_mesh(model_, source, uv_set(source.material), name);
      Shape& shape = from_file.shape;
      shape.node = use.node;
      if (node.skin >= 0) {
        shape.skin = node.skin;
        const Skin& skin = scene_.rig.skins[static_cast<std::size_t>(node.skin)];
        read_influences(model_, source, skin.joints.size(), name, shape);
      }
      primitive.moves = is_moving(shape);
      primitive.turns_inside_out = shape.skin < 0 && may_mirror_[use.node];
      add_primitive(std::move(from_file), primitive, name);
    }
  }

  [[nodiscard]] bool is_moving(const Shape& shape) const {
    if (!shape.targets.empty() && weights_move_[shape.node]) return true;
    if (shape.skin < 0) return moves_[shape.node];
    const auto& joints = scene_.rig.skins[static_cast<std::size_t>(shape.skin)].joints;
    return std::any_of(joints.begin(), joints.end(), [&](std::size_t joint) { return moves_[joint]; });
  }

  [[nodiscard]] int uv_set(int material) const {
    return material < 0 ? 0 : uv_sets_[static_cast<std::size_t>(material)];
  }

  // A mesh that several nodes show is said once.
  void leave_out(std::string what) {
    auto& list = scene_.left_out;
    if (std::find(list.begin(), list.end(), what) == list.end()) list.push_back(std::move(what));
  }

  // Its own copy of the material where the primitive, mesh or node carries extras.phong.
  int primitive_material(const tinygltf::Node& node, const tinygltf::Mesh& mesh,
                         const tinygltf::Primitive& source, const std::string& what) {
    Material m;
    if (source.material >= 0) {
      m = scene_.materials[index_in(model_.materials.size(), source.material, what + ": material")];
      if (m.model == Material::Model::phong) return source.material;
    }
    const bool phong = apply_phong(source.extras, what, m) || apply_phong(mesh.extras, what, m) ||
                       apply_phong(node.extras, what, m);
    if (!phong && source.material >= 0) return source.material;
    scene_.materials.push_back(m);
    return static_cast<int>(scene_.materials.size()) - 1;
  }

  // Drops triangles of no area. A vertex without a normal becomes one for each triangle, which gets the triangle's.
  void add_primitive(MeshFromFile mesh, Primitive primitive, const std::string& what) {
    if (mesh.triangles.size() / 3 + scene_.triangles() > kMostTriangles)
      throw BadScene{"has more than " + std::to_string(kMostTriangles) + " triangles"};
    Shape& shape = mesh.shape;
    shape.mirrored = mirrors(scene_.rig, shape, pose_);
    PosedShape posed;
    pose_shape(scene_.rig, shape, pose_, posed);
    for (std::size_t i = 0; i < posed.positions.size(); ++i)
      if (!posed.positions[i].allFinite())
        throw BadScene{what + ": vertex " + std::to_string(i) + " is not finite"};
    // What an animation brings down to nothing at times is there at others.
    const bool may_open = primitive.moves && (shape.skin >= 0 || !shape.targets.empty());
    const std::vector<Vec3f>& positions = primitive.moves ? shape.positions : posed.positions;
    const std::vector<Vec3f>& normals = primitive.moves ? shape.normals : posed.normals;

    constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> place(positions.size(), kNone);
    std::vector<std::uint32_t> origin;
    primitive.first_index = static_cast<std::uint32_t>(scene_.indices.size());
    primitive.first_vertex = static_cast<std::uint32_t>(scene_.vertices.size());
    for (std::size_t t = 0; t + 2 < mesh.triangles.size(); t += 3) {
      std::uint32_t corner[3] = {mesh.triangles[t], mesh.triangles[t + 1], mesh.triangles[t + 2]};
      if (shape.mirrored) std::swap(corner[1], corner[2]);
      const bool distinct = corner[0] != corner[1] && corner[1] != corner[2] && corner[2] != corner[0];
      if (!distinct || (!may_open && !has_area(positions, corner))) {
        ++scene_.dropped_triangles;
        continue;
      }
      for (const std::uint32_t c : corner) {
        const bool flat = normals[c].isZero();
        if (flat || place[c] == kNone) {
          place[c] = primitive.first_vertex + static_cast<std::uint32_t>(origin.size());
          origin.push_back(c);
        }
        scene_.indices.push_back(place[c]);
      }
    }
    primitive.index_count = static_cast<std::uint32_t>(scene_.indices.size()) - primitive.first_index;
    primitive.vertex_count = static_cast<std::uint32_t>(origin.size());
    if (primitive.index_count == 0) return;
    scene_.vertices.reserve(scene_.vertices.size() + origin.size());
    for (const std::uint32_t i : origin) {
      Vertex& v = scene_.vertices.emplace_back();
      v.position = posed.positions[i];
      v.normal = posed.normals[i];
      if (!mesh.uvs.empty()) v.uv = mesh.uvs[i];
      if (!mesh.colors.empty()) v.color = mesh.colors[i];
    }
    fill_flat_normals(scene_, primitive);
    if (primitive.moves) keep_shape(shape, origin, primitive);
    scene_.primitives.push_back(primitive);
  }

  static bool has_area(const std::vector<Vec3f>& positions, const std::uint32_t (&corner)[3]) {
    const Vec3d a = positions[corner[0]].cast<double>();
    const Vec3d cross =
        (positions[corner[1]].cast<double>() - a).cross(positions[corner[2]].cast<double>() - a);
    return cross.norm() > 0;
  }

  // The shape with its vertices in the scene's order.
  void keep_shape(const Shape& source, const std::vector<std::uint32_t>& origin, const Primitive& primitive) {
    const auto gathered = [&](const auto& from, std::size_t width) {
      std::remove_cvref_t<decltype(from)> to;
      if (from.empty()) return to;
      to.reserve(origin.size() * width);
      for (const std::uint32_t i : origin)
        to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(i * width),
                  from.begin() + static_cast<std::ptrdiff_t>((i + 1) * width));
      return to;
    };
    Shape& shape = scene_.rig.shapes.emplace_back();
    shape.primitive = scene_.primitives.size();
    shape.node = source.node;
    shape.skin = source.skin;
    shape.mirrored = source.mirrored;
    shape.first_vertex = primitive.first_vertex;
    shape.positions = gathered(source.positions, 1);
    shape.normals = gathered(source.normals, 1);
    shape.influences = source.influences;
    shape.joints = gathered(source.joints, source.influences);
    shape.joint_weights = gathered(source.joint_weights, source.influences);
    for (const MorphTarget& target : source.targets) {
      MorphTarget& to = shape.targets.emplace_back();
      to = {gathered(target.positions, 1), gathered(target.normals, 1)};
      // Vertices without a normal keep none: it is their triangle's.
      for (std::size_t i = 0; i < to.normals.size(); ++i)
        if (shape.normals[i].isZero()) to.normals[i].setZero();
    }
  }

  const tinygltf::Model& model_;
  Scene scene_;
  Pose pose_;
  RigPlaces places_;
  std::vector<Use> uses_;
  std::vector<int> uv_sets_;
  std::set<std::size_t> used_skins_;
  std::vector<std::size_t> weight_counts_;  // a node of the rig, as the next three
  std::vector<bool> moves_;
  std::vector<bool> weights_move_;
  std::vector<bool> may_mirror_;
};

std::string one_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  for (char& c : text)
    if (c == '\n' || c == '\r') c = ' ';
  return text.empty() ? "is not glTF 2.0" : text;
}

}  // namespace

Result<Scene> read_gltf(const std::filesystem::path& file, const std::string& animation) {
  const auto bad = [&](const std::string& why, ErrorKind kind = ErrorKind::bad_input) {
    return Error{kind, file.string() + ": " + why};
  };
  const auto text = read_text_file(file);
  if (!text) return text.error();
  tinygltf::Model model;
  try {
    tinygltf::TinyGLTF loader;
    std::string error;
    std::string warning;
    const std::string folder = file.has_parent_path() ? file.parent_path().string() : ".";
    if (text->size() > std::numeric_limits<unsigned int>::max())
      return bad("is larger than 4294967295 bytes");
    const auto length = static_cast<unsigned int>(text->size());
    const bool binary = text->starts_with("glTF");
    const bool read =
        binary ? loader.LoadBinaryFromMemory(&model, &error, &warning,
                                             reinterpret_cast<const unsigned char*>(text->data()), length,
                                             folder)
               : loader.LoadASCIIFromString(&model, &error, &warning, text->c_str(), length, folder);
    if (!read || !error.empty()) return bad(one_line(error));
    return Reader(model).read(animation);
  } catch (const BadScene& e) {
    return bad(e.message, e.kind);
  } catch (const std::bad_alloc&) {
    return bad("does not fit into this machine's memory", ErrorKind::failed);
  } catch (const std::exception& e) {
    return bad(one_line(e.what()));
  }
}

}  // namespace lightwell::render
