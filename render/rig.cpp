// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/rig.h"

#include <cmath>

namespace lightwell::render {
namespace {

Mat4f local(const RigNode& node) {
  if (node.matrix) return *node.matrix;
  Eigen::Affine3d t = Eigen::Affine3d::Identity();
  t.translate(node.translation);
  t.rotate(node.rotation);
  t.scale(node.scale);
  return t.matrix().cast<float>();
}

Pose pose_of(const std::vector<RigNode>& nodes) {
  Pose pose;
  pose.world_from_node.reserve(nodes.size());
  for (const RigNode& node : nodes) {
    const Mat4f own = local(node);
    pose.world_from_node.push_back(
        node.parent < 0 ? own : Mat4f(pose.world_from_node[static_cast<std::size_t>(node.parent)] * own));
    pose.weights.push_back(node.weights);
  }
  return pose;
}

void move_node(const Track& track, double time_s, RigNode& node) {
  if (track.property == Track::Property::weights) {
    node.weights.resize(track.width);
    sample(track, time_s, node.weights);
    return;
  }
  float value[4] = {};
  sample(track, time_s, std::span(value).first(track.width));
  const Vec3d v(value[0], value[1], value[2]);
  if (track.property == Track::Property::translation) node.translation = v;
  if (track.property == Track::Property::scale) node.scale = v;
  if (track.property == Track::Property::rotation)
    node.rotation = Eigen::Quaterniond(value[3], value[0], value[1], value[2]).normalized();
}

// Carries directions across surfaces: the inverse transpose times the determinant, which exists for any scale.
Eigen::Matrix3f cofactor(const Eigen::Matrix3f& m) {
  Eigen::Matrix3f c;
  c << m.col(1).cross(m.col(2)), m.col(2).cross(m.col(0)), m.col(0).cross(m.col(1));
  return c;
}

Vec3f unit_or_zero(const Vec3f& v) {
  // Cofactors of a scale of 1e-6 are 1e-12: their squares would be lost in single precision.
  const double length = v.cast<double>().norm();
  return length > 0 && std::isfinite(length) ? Vec3f((v.cast<double>() / length).cast<float>())
                                             : Vec3f(Vec3f::Zero());
}

// The matrices that a skin's joints carry vertices with (glTF 2.0, 3.7.3.3): the node's own transform has no part.
std::vector<Mat4f> joint_matrices(const Rig& rig, const Shape& shape, const Pose& pose) {
  const Skin& skin = rig.skins[static_cast<std::size_t>(shape.skin)];
  std::vector<Mat4f> matrices;
  for (std::size_t j = 0; j < skin.joints.size(); ++j)
    matrices.push_back(pose.world_from_node[skin.joints[j]] * skin.joint_from_mesh[j]);
  return matrices;
}

void add_targets(const Shape& shape, const std::vector<float>& weights, PosedShape& posed) {
  for (std::size_t t = 0; t < shape.targets.size() && t < weights.size(); ++t) {
    const float weight = weights[t];
    if (weight == 0) continue;
    const MorphTarget& target = shape.targets[t];
    const auto add = [weight](const std::vector<Vec3f>& from, std::vector<Vec3f>& to) {
      for (std::size_t i = 0; i < from.size() && i < to.size(); ++i) to[i] += weight * from[i];
    };
    add(target.positions, posed.positions);
    add(target.normals, posed.normals);
  }
}

void carry(const Mat4f& m, float side, std::size_t i, PosedShape& posed) {
  const Eigen::Matrix3f linear = m.topLeftCorner<3, 3>();
  posed.positions[i] = linear * posed.positions[i] + m.topRightCorner<3, 1>();
  posed.normals[i] = unit_or_zero(side * cofactor(linear) * posed.normals[i]);
}

}  // namespace

Pose rest_pose(const Rig& rig) {
  return pose_of(rig.nodes);
}

Pose pose_at(const Rig& rig, double time_s) {
  std::vector<RigNode> nodes = rig.nodes;
  const double t = looped(time_s, rig.length_s);
  for (const Track& track : rig.tracks) move_node(track, t, nodes[track.node]);
  return pose_of(nodes);
}

void pose_shape(const Rig& rig, const Shape& shape, const Pose& pose, PosedShape& posed) {
  posed.positions = shape.positions;
  posed.normals = shape.normals;
  add_targets(shape, pose.weights[shape.node], posed);
  const float side = shape.mirrored ? -1.0f : 1.0f;
  if (shape.skin < 0) {
    const Mat4f& m = pose.world_from_node[shape.node];
    for (std::size_t i = 0; i < posed.positions.size(); ++i) carry(m, side, i, posed);
    return;
  }
  const std::vector<Mat4f> joints = joint_matrices(rig, shape, pose);
  for (std::size_t i = 0; i < posed.positions.size(); ++i) {
    Mat4f blended = Mat4f::Zero();
    for (std::size_t k = i * shape.influences; k < (i + 1) * shape.influences; ++k)
      if (shape.joint_weights[k] != 0) blended += shape.joint_weights[k] * joints[shape.joints[k]];
    carry(blended, side, i, posed);
  }
}

bool mirrors(const Rig& rig, const Shape& shape, const Pose& pose) {
  if (shape.skin < 0)
    return pose.world_from_node[shape.node].topLeftCorner<3, 3>().cast<double>().determinant() < 0;
  const auto joints = joint_matrices(rig, shape, pose);
  return !joints.empty() && joints[0].topLeftCorner<3, 3>().cast<double>().determinant() < 0;
}

}  // namespace lightwell::render
