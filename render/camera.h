// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "render/scene.h"

namespace lightwell::render {

// What a picture is taken with.
struct View {
  Mat4f clip_from_world = Mat4f::Identity();
  Vec3f eye = Vec3f::Zero();
  // Direction through a point of the picture: forward + right · x + up · y, x and y in [−1, 1], +y at the
  // top.
  Vec3f forward = -Vec3f::UnitZ();
  Vec3f right = Vec3f::UnitX();
  Vec3f up = Vec3f::UnitY();
};

// offset_px: shift of the sample inside the pixel, (0,0) its centre, in (−½, ½).
View make_view(const SceneCamera& camera, int width, int height, const Vec2f& offset_px = Vec2f::Zero());

// Looks down at the whole scene from the front, for files without a camera.
SceneCamera fitted_camera(const Scene& scene);

// Camera on a sphere around a target, moved by a mouse.
class Orbit {
 public:
  // Starts exactly at the given camera; the target is the point of its axis nearest to the scene's centre.
  Orbit(const SceneCamera& start, const Scene& scene);
  // Stands exactly at this camera; the target stays as far away as it was.
  void start_at(const SceneCamera& camera);
  void turn(float right_rad, float up_rad);
  void zoom(float factor);
  // Moves camera and target, in distances between them.
  void slide(float right, float up);
  [[nodiscard]] const SceneCamera& camera() const { return camera_; }

 private:
  void update();
  SceneCamera camera_;
  Vec3f target_ = Vec3f::Zero();
  float distance_ = 1;
  float farthest_ = 1;
  float azimuth_rad_ = 0;
  float elevation_rad_ = 0;
};

}  // namespace lightwell::render
