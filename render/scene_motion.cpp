// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/scene_motion.h"

#include <algorithm>

namespace lightwell::render {

SceneMotion::SceneMotion(Scene& scene) : scene_(scene), pose_(pose_at(scene.rig, 0)) {}

Status SceneMotion::move_to(double time_s) {
  Pose pose = pose_at(scene_.rig, time_s);
  moved_.clear();
  camera_moved_ = false;
  for (const Shape& shape : scene_.rig.shapes) {
    if (!differs(shape, pose)) continue;
    pose_shape(scene_.rig, shape, pose, posed_);
    for (std::size_t i = 0; i < posed_.positions.size(); ++i) {
      if (!posed_.positions[i].allFinite())
        return Error{ErrorKind::bad_input, "the animation moves something to infinity at " +
                                               std::to_string(looped(time_s, scene_.rig.length_s)) + " s"};
      Vertex& v = scene_.vertices[shape.first_vertex + i];
      v.position = posed_.positions[i];
      v.normal = posed_.normals[i];
    }
    fill_flat_normals(scene_, scene_.primitives[shape.primitive]);
    moved_.push_back(shape.primitive);
  }
  for (const Rig::Camera& c : scene_.rig.cameras) {
    const Mat4f place = camera_at_node(pose.world_from_node[c.node]);
    // A node scaled to 0 has no axes: its camera stays where it was.
    if (!place.allFinite()) continue;
    camera_moved_ = camera_moved_ || place != scene_.cameras[c.camera].world_from_camera;
    scene_.cameras[c.camera].world_from_camera = place;
  }
  pose_ = std::move(pose);
  return {};
}

bool SceneMotion::differs(const Shape& shape, const Pose& pose) const {
  if (!shape.targets.empty() && pose.weights[shape.node] != pose_.weights[shape.node]) return true;
  const auto turned = [&](std::size_t node) {
    return pose.world_from_node[node] != pose_.world_from_node[node];
  };
  if (shape.skin < 0) return turned(shape.node);
  const auto& joints = scene_.rig.skins[static_cast<std::size_t>(shape.skin)].joints;
  return std::any_of(joints.begin(), joints.end(), turned);
}

Mat4f camera_at_node(const Mat4f& world_from_node) {
  Mat4f m = world_from_node;
  for (int c = 0; c < 3; ++c) m.col(c).head<3>() /= m.col(c).head<3>().norm();
  return m;
}

void fill_flat_normals(Scene& scene, const Primitive& primitive) {
  for (std::uint32_t i = primitive.first_index; i < primitive.first_index + primitive.index_count; i += 3) {
    Vertex* corner[3];
    for (std::uint32_t c = 0; c < 3; ++c) corner[c] = &scene.vertices[scene.indices[i + c]];
    if (!(corner[0]->normal.isZero() || corner[1]->normal.isZero() || corner[2]->normal.isZero())) continue;
    const Vec3d a = corner[0]->position.cast<double>();
    const Vec3d cross =
        (corner[1]->position.cast<double>() - a).cross(corner[2]->position.cast<double>() - a);
    if (!(cross.norm() > 0)) continue;
    for (Vertex* v : corner)
      if (v->normal.isZero()) v->normal = cross.normalized().cast<float>();
  }
}

}  // namespace lightwell::render
