// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lighting/vector.h"
#include "render/animation.h"

namespace lightwell::render {

using Mat4f = Eigen::Matrix4f;

// Transform of a node from its parent's space: a matrix, or scale, then rotation, then translation.
struct RigNode {
  std::string name;
  int parent = -1;  // stands earlier in the list
  Vec3d translation = Vec3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Vec3d scale = Vec3d::Ones();
  std::optional<Mat4f> matrix;
  std::vector<float> weights;  // of the morph targets of the node's mesh
};

struct Skin {
  std::vector<std::size_t> joints;  // nodes
  std::vector<Mat4f> joint_from_mesh;
};

// What a morph target adds at weight 1, a vector a vertex; empty: nothing.
struct MorphTarget {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;
};

// A primitive as it is in its node's space, before morphing, skinning and the node's transform.
struct Shape {
  std::size_t primitive = 0;  // of the scene
  std::size_t node = 0;
  int skin = -1;
  // The transform mirrored when the order of corners was chosen, so normals that it carries are turned round.
  bool mirrored = false;
  std::uint32_t first_vertex = 0;  // of the scene; as many as positions
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;  // zero: of the vertex's triangle, which no other shares
  std::size_t influences = 0;  // joints a vertex
  std::vector<std::uint16_t> joints;
  std::vector<float> joint_weights;  // sum to 1 a vertex
  std::vector<MorphTarget> targets;
};

// Nodes, what hangs on them, and how they move.
struct Rig {
  std::vector<RigNode> nodes;
  std::vector<Skin> skins;
  std::vector<Track> tracks;
  double length_s = 0;        // to the last key; then it begins again
  std::vector<Shape> shapes;  // those that move; all others stand in the scene as they are
  struct Camera {
    std::size_t camera = 0;  // of the scene
    std::size_t node = 0;
  };
  std::vector<Camera> cameras;  // those that move

  [[nodiscard]] bool moves() const { return !shapes.empty() || !cameras.empty(); }
};

// The nodes at one time.
struct Pose {
  std::vector<Mat4f> world_from_node;
  std::vector<std::vector<float>> weights;
};

// As the nodes stand in the file.
Pose rest_pose(const Rig& rig);
// At a time of the animation, which begins again at its end.
Pose pose_at(const Rig& rig, double time_s);

// Vertices of a shape in world space.
struct PosedShape {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;  // unit, or zero where the shape has none
};
// reuses what posed holds; allocates only where it grows
void pose_shape(const Rig& rig, const Shape& shape, const Pose& pose, PosedShape& posed);

// True where the transform from a shape's space mirrors, so that triangles turn inside out.
bool mirrors(const Rig& rig, const Shape& shape, const Pose& pose);

}  // namespace lightwell::render
