// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/casters.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "render/caster_mesh.h"
#include "render/surface_distance.h"

namespace lightwell::render {
namespace {

using Index = std::uint32_t;
constexpr Index kNone = std::numeric_limits<Index>::max();

// Where the vertices of a primitive that bends or grows are at some times of the animation.
using Poses = std::vector<std::vector<Vec3f>>;

struct MovingPart {
  Poses poses;                 // empty: it keeps its shape
  std::vector<Vec3f> centres;  // of its box, at each of these times
};

// Triangles of a primitive by welded corners.
struct Mesh {
  std::size_t primitive = 0;
  enum Run { closed, open, support, cutout } run = open;
  std::vector<Vec3f> positions;
  std::vector<Index> vertices;  // of the scene, a position
  std::vector<Index> triangles;
  Sphere bounds;
};

std::size_t hash(const Vec3f& p) {
  std::uint64_t h = 0;
  // +0 and −0 are one place.
  for (const float x : p) h = (h ^ std::bit_cast<std::uint32_t>(x + 0.0f)) * 0x9e3779b97f4a7c15u;
  return static_cast<std::size_t>(h ^ (h >> 29));
}

// Corners in one place are one, where they stay in one place in all poses.
Mesh weld(const Scene& scene, std::size_t number, const Poses& poses) {
  const Primitive& primitive = scene.primitives[number];
  Mesh mesh;
  mesh.primitive = number;
  mesh.triangles.reserve(primitive.index_count);
  const auto indices = std::span(scene.indices).subspan(primitive.first_index, primitive.index_count);
  if (indices.empty()) return mesh;
  const auto [least, most] = std::minmax_element(indices.begin(), indices.end());
  const Index first = *least;
  // A vertex is looked for once, where those in use stand together.
  const std::size_t range = *most - first + std::size_t{1};
  std::vector<Index> known(range <= 2 * indices.size() ? range : 0, kNone);
  const std::size_t slots = std::bit_ceil(std::min(range, indices.size()) * 2 + 1);
  std::vector<Index> table(slots, kNone);
  const auto together = [&](Index a, Index b) {
    if (scene.vertices[a].position != scene.vertices[b].position) return false;
    return std::all_of(poses.begin(), poses.end(), [&](const std::vector<Vec3f>& pose) {
      return pose[a - primitive.first_vertex] == pose[b - primitive.first_vertex];
    });
  };
  const auto corner_of = [&](Index vertex) {
    const Vec3f& p = scene.vertices[vertex].position;
    std::size_t slot = hash(p) & (slots - 1);
    while (table[slot] != kNone && !together(mesh.vertices[table[slot]], vertex))
      slot = (slot + 1) & (slots - 1);
    if (table[slot] == kNone) {
      table[slot] = static_cast<Index>(mesh.positions.size());
      mesh.positions.push_back(p);
      mesh.vertices.push_back(vertex);
    }
    return table[slot];
  };
  for (const Index vertex : indices) {
    if (known.empty()) {
      mesh.triangles.push_back(corner_of(vertex));
      continue;
    }
    Index& corner = known[vertex - first];
    if (corner == kNone) corner = corner_of(vertex);
    mesh.triangles.push_back(corner);
  }
  return mesh;
}

// The front-facing normal where the triangles lie in one plane, facing one way, with the scene at or above
// it.
std::optional<Vec3f> support_normal(const Mesh& mesh, float tolerance, const Scene& scene,
                                    const std::vector<MovingPart>& moving) {
  const std::vector<Index>& triangles = mesh.triangles;
  const std::vector<Vec3f>& positions = mesh.positions;
  const auto normal_of = [&](std::size_t t) {
    const Vec3d a = positions[triangles[t]].cast<double>();
    return Vec3f((positions[triangles[t + 1]].cast<double>() - a)
                     .cross(positions[triangles[t + 2]].cast<double>() - a)
                     .normalized()
                     .cast<float>());
  };
  if (triangles.empty() || scene.primitives[mesh.primitive].moves) return std::nullopt;
  const Vec3f n = normal_of(0);
  const float height = n.dot(positions[triangles[0]]);
  for (const Index i : triangles)
    if (std::abs(n.dot(positions[i]) - height) > tolerance) return std::nullopt;
  for (std::size_t t = 0; t < triangles.size(); t += 3)
    if (n.dot(normal_of(t)) < 0.5f) return std::nullopt;
  for (std::size_t p = 0; p < scene.primitives.size(); ++p) {
    const Primitive& other = scene.primitives[p];
    if (other.moves) {
      for (const Vec3f& centre : moving[p].centres)
        if (n.dot(centre) < height - tolerance) return std::nullopt;
      continue;
    }
    for (Index i = other.first_index; i < other.first_index + other.index_count; ++i)
      if (n.dot(scene.vertices[scene.indices[i]].position) < height - tolerance) return std::nullopt;
  }
  return n;
}

struct Box {
  Vec3f low = Vec3f::Constant(std::numeric_limits<float>::max());
  Vec3f high = Vec3f::Constant(std::numeric_limits<float>::lowest());
  void add(const Vec3f& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
};

// A primitive that is carried as a whole, without growing, looks alike in every pose.
bool keeps_its_shape(const Rig& rig, const Shape& shape, const std::vector<Pose>& poses) {
  if (shape.skin >= 0 || !shape.targets.empty()) return false;
  const auto gram = [&](const Pose& pose) {
    const Eigen::Matrix3d m = pose.world_from_node[shape.node].topLeftCorner<3, 3>().cast<double>();
    return Eigen::Matrix3d(m.transpose() * m);
  };
  // Single precision leaves a rotation this far from one.
  constexpr double kRounding = 1e-5;
  const Eigen::Matrix3d first = gram(pose_at(rig, 0));
  return std::all_of(poses.begin(), poses.end(), [&](const Pose& pose) {
    return (gram(pose) - first).norm() <= kRounding * first.norm();
  });
}

// A number of the scene's primitive each; empty where a primitive stands still.
std::vector<MovingPart> sample_motion(const Scene& scene) {
  std::vector<MovingPart> parts(scene.primitives.size());
  if (!scene.rig.moves()) return parts;
  constexpr int kPoses = 8;  // beside that of time 0
  std::vector<Pose> poses;
  for (int i = 0; i < kPoses; ++i)
    poses.push_back(pose_at(scene.rig, scene.rig.length_s * (i + 0.5) / kPoses));
  PosedShape posed;
  for (const Shape& shape : scene.rig.shapes) {
    MovingPart& part = parts[shape.primitive];
    const bool rigid = keeps_its_shape(scene.rig, shape, poses);
    for (const Pose& pose : poses) {
      pose_shape(scene.rig, shape, pose, posed);
      Box box;
      for (const Vec3f& p : posed.positions) box.add(p);
      part.centres.push_back((box.low + box.high) / 2);
      if (!rigid) part.poses.push_back(posed.positions);
    }
  }
  return parts;
}

std::vector<Vec3f> positions_in(const std::vector<Vec3f>& pose, const Mesh& mesh, Index first_vertex) {
  std::vector<Vec3f> positions(mesh.positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = pose[mesh.vertices[i] - first_vertex];
  return positions;
}

// What bends is simplified where it is bent most, and the other way round, until that holds in all poses. spent_m: how
// far the mesh is from the scene's already.
void simplify_mesh(Mesh& mesh, const Scene& scene, const Poses& poses, float max_distance_m, float spent_m) {
  std::vector<std::vector<Vec3f>> shapes = {mesh.positions};
  const Index first_vertex = scene.primitives[mesh.primitive].first_vertex;
  std::size_t most_bent = 0;
  double most_m2 = 0;
  for (const std::vector<Vec3f>& pose : poses) {
    shapes.push_back(positions_in(pose, mesh, first_vertex));
    double sum_m2 = 0;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
      sum_m2 += static_cast<double>((shapes.back()[i] - mesh.positions[i]).squaredNorm());
    if (sum_m2 > most_m2) most_m2 = sum_m2, most_bent = shapes.size() - 1;
  }
  const float left_m = max_distance_m - spent_m;
  const auto try_with = [&](std::size_t shape, float share_m) {
    std::vector<Index> fewer = simplify(mesh.triangles, shapes[shape], spent_m + share_m, spent_m);
    for (std::size_t i = 0; i < shapes.size(); ++i)
      if (i != shape && !stay_together(mesh.triangles, fewer, shapes[i], static_cast<double>(left_m)))
        return false;
    mesh.triangles = std::move(fewer);
    return true;
  };
  for (const float share_m : {left_m, left_m / 2, left_m / 4})
    if (try_with(most_bent, share_m) || (most_bent != 0 && try_with(0, share_m)) || shapes.size() == 1)
      return;
}

Casters::Body body_of(const Mesh& mesh, bool casts) {
  return {mesh.primitive, casts, mesh.positions, mesh.vertices};
}

// Corners that are left stand together in the order of their use.
void append(const Mesh& mesh, bool with_vertices, Casters& casters) {
  Casters::Part part;
  part.primitive = mesh.primitive;
  part.bounds = mesh.bounds;
  part.first_index = static_cast<Index>(casters.indices.size());
  part.index_count = static_cast<Index>(mesh.triangles.size());
  part.first_position = static_cast<Index>(casters.positions.size());
  std::vector<Index> place(mesh.positions.size(), kNone);
  for (const Index i : mesh.triangles) {
    if (place[i] == kNone) {
      place[i] = static_cast<Index>(casters.positions.size());
      casters.positions.push_back(mesh.positions[i]);
      if (with_vertices) casters.vertices.push_back(mesh.vertices[i]);
    }
    casters.indices.push_back(place[i]);
  }
  part.position_count = static_cast<Index>(casters.positions.size()) - part.first_position;
  Index* const counts[] = {&casters.closed_count, &casters.open_count, &casters.support_count};
  if (mesh.run != Mesh::cutout) *counts[mesh.run] += part.index_count;
  casters.parts.push_back(part);
}

// The spheres, of all bodies.
void bound(Casters& casters) {
  std::vector<Vec3f> points;
  bool objects_done = false;
  for (const Casters::Body& body : casters.bodies) {
    if (!body.casts && !objects_done) casters.objects = bounding_sphere(points), objects_done = true;
    points.insert(points.end(), body.positions.begin(), body.positions.end());
  }
  casters.scene = bounding_sphere(points);
  if (!objects_done) casters.objects = casters.scene;
}

}  // namespace

bool Casters::needs_supports(const Vec3f& to_light) const {
  for (const Vec3f& n : support_normals)
    if (n.dot(to_light) <= 0) return true;
  return false;
}

void Casters::move(const Scene& scene_now, std::span<const std::size_t> moved) {
  const auto has_moved = [&](std::size_t primitive) {
    return std::binary_search(moved.begin(), moved.end(), primitive);
  };
  for (Part& part : parts) {
    part.moved = has_moved(part.primitive);
    if (!part.moved) continue;
    for (Index i = part.first_position; i < part.first_position + part.position_count; ++i)
      positions[i] = scene_now.vertices[vertices[i]].position;
  }
  if (moved.empty()) return;
  for (Body& body : bodies) {
    if (!has_moved(body.primitive)) continue;
    for (std::size_t i = 0; i < body.vertices.size(); ++i)
      body.positions[i] = scene_now.vertices[body.vertices[i]].position;
    if (!body.casts) continue;
    const auto part = std::find_if(parts.begin(), parts.end(),
                                   [&](const Part& p) { return p.primitive == body.primitive; });
    part->bounds = bounding_sphere(body.positions);
  }
  bound(*this);
}

float Casters::farthest_move(const Scene& scene_now, std::span<const std::size_t> moved) const {
  float farthest = 0;
  for (const Body& body : bodies) {
    if (!body.casts || !std::binary_search(moved.begin(), moved.end(), body.primitive)) continue;
    for (std::size_t i = 0; i < body.vertices.size(); ++i)
      farthest = std::max(farthest,
                          (scene_now.vertices[body.vertices[i]].position - body.positions[i]).squaredNorm());
  }
  return std::sqrt(farthest);
}

namespace {

// What all levels of simplification have in common.
struct Prepared {
  Casters casters;  // without triangles
  std::vector<Mesh> meshes;
  std::vector<MovingPart> moving;
};

Prepared prepare(const Scene& scene) {
  Prepared prepared;
  Casters& casters = prepared.casters;
  casters.is_support.assign(scene.primitives.size(), false);
  Box box;
  for (const Index i : scene.indices) box.add(scene.vertices[i].position);
  // Single precision leaves this much of the scene's size in a transformed plane.
  const float tolerance = 1e-5f * (box.high - box.low).norm();
  prepared.moving = sample_motion(scene);
  const std::vector<MovingPart>& moving = prepared.moving;

  std::vector<Mesh>& meshes = prepared.meshes;
  for (std::size_t p = 0; p < scene.primitives.size(); ++p) {
    const Primitive& primitive = scene.primitives[p];
    if (!primitive.casts_shadow) continue;
    Mesh mesh = weld(scene, p, moving[p].poses);
    const bool has_holes = scene.materials[static_cast<std::size_t>(primitive.material)].alpha_cutoff > 0;
    const auto normal = has_holes ? std::nullopt : support_normal(mesh, tolerance, scene, moving);
    casters.is_support[p] = normal.has_value();
    if (normal) {
      casters.support_normals.push_back(*normal);
      mesh.run = Mesh::support;
    } else {
      mesh.run = !primitive.turns_inside_out && is_closed(mesh.triangles) ? Mesh::closed : Mesh::open;
      if (has_holes) mesh.run = Mesh::cutout;
      mesh.bounds = bounding_sphere(mesh.positions);
      casters.bodies.push_back(body_of(mesh, true));
    }
    meshes.push_back(std::move(mesh));
  }
  for (std::size_t p = 0; p < scene.primitives.size(); ++p)
    if (!scene.primitives[p].casts_shadow)
      casters.bodies.push_back(body_of(weld(scene, p, moving[p].poses), false));
  bound(casters);
  for (Mesh& mesh : meshes) {
    if (mesh.run != Mesh::cutout) continue;
    casters.cutouts.push_back(mesh.primitive);
    mesh.triangles.clear();
  }
  if (!scene.rig.moves()) casters.bodies.clear();
  return prepared;
}

Casters assemble(const Casters& common, const std::vector<Mesh>& meshes, bool moves) {
  Casters casters = common;
  for (const Mesh::Run run : {Mesh::closed, Mesh::open, Mesh::support, Mesh::cutout})
    for (const Mesh& mesh : meshes)
      if (mesh.run == run) append(mesh, moves, casters);
  return casters;
}

}  // namespace

std::vector<Casters> find_casters(const Scene& scene, std::span<const int> map_sizes) {
  Prepared prepared = prepare(scene);
  std::vector<Mesh>& meshes = prepared.meshes;
  const bool moves = scene.rig.moves();
  std::vector<Casters> levels;
  // Of each mesh as it is drawn: how far it is from the scene's. Small ones are simplified from the scene's each time,
  // which leaves fewer triangles.
  constexpr std::size_t kLarge = 3 * 100'000;
  std::vector<float> spent_m(meshes.size(), 0);
  std::vector<std::vector<Index>> of_scene;
  for (const Mesh& mesh : meshes)
    of_scene.push_back(mesh.triangles.size() > kLarge ? std::vector<Index>() : mesh.triangles);
  for (const int size : map_sizes) {
    const float texel_m = size > 0 ? 2 * prepared.casters.objects.radius / static_cast<float>(size) : 0;
    const float max_distance_m = kSimplifiedTexels * texel_m;
    for (std::size_t i = 0; i < meshes.size() && max_distance_m > 0; ++i) {
      Mesh& mesh = meshes[i];
      if (mesh.run != Mesh::closed && mesh.run != Mesh::open) continue;
      if (!of_scene[i].empty()) mesh.triangles = of_scene[i];
      simplify_mesh(mesh, scene, prepared.moving[mesh.primitive].poses, max_distance_m, spent_m[i]);
      if (of_scene[i].empty()) spent_m[i] = max_distance_m;
    }
    levels.push_back(assemble(prepared.casters, meshes, moves));
  }
  return levels;
}

Casters find_casters(const Scene& scene, int map_size) {
  return std::move(find_casters(scene, std::array{map_size}).front());
}

}  // namespace lightwell::render
