// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lighting/result.h"
#include "render/scene.h"

namespace lightwell::render {

// Moves a scene along its animation: vertices of the primitives that move, and cameras.
class SceneMotion {
 public:
  // scene: stands at time 0, as it is read; lives longer than this.
  explicit SceneMotion(Scene& scene);
  // Goes to a time of the animation, which begins again at its end. bad_input: something comes to lie at infinity.
  Status move_to(double time_s);
  // Primitives whose vertices the last move changed, rising. What stands still for a while is not among them.
  [[nodiscard]] std::span<const std::size_t> moved() const { return moved_; }
  // The nodes as they stand.
  [[nodiscard]] const Pose& pose() const { return pose_; }
  // True where the last move changed a camera.
  [[nodiscard]] bool camera_moved() const { return camera_moved_; }

 private:
  [[nodiscard]] bool differs(const Shape& shape, const Pose& pose) const;
  Scene& scene_;
  Pose pose_;
  PosedShape posed_;
  std::vector<std::size_t> moved_;
  bool camera_moved_ = false;
};

// World from camera where its node stands: along the node's axes, without their scale (glTF 2.0, 3.10.2).
Mat4f camera_at_node(const Mat4f& world_from_node);

// Vertices without a normal get that of their triangle.
void fill_flat_normals(Scene& scene, const Primitive& primitive);

}  // namespace lightwell::render
