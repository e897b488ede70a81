// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/camera.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace lightwell::render {
namespace {

struct Box {
  Vec3f low = Vec3f::Constant(std::numeric_limits<float>::max());
  Vec3f high = Vec3f::Constant(std::numeric_limits<float>::lowest());
  [[nodiscard]] Vec3f centre() const { return (low + high) / 2; }
  [[nodiscard]] float radius() const { return std::max((high - low).norm() / 2, 1e-12f); }
};

Box bounds(const Scene& scene) {
  Box box;
  for (const std::uint32_t i : scene.indices) {
    box.low = box.low.cwiseMin(scene.vertices[i].position);
    box.high = box.high.cwiseMax(scene.vertices[i].position);
  }
  return box;
}

Mat4f look_at(const Vec3f& eye, const Vec3f& back) {
  Mat4f m = Mat4f::Identity();
  const Vec3f right = Vec3f::UnitY().cross(back).normalized();
  m.col(0).head<3>() = right;
  m.col(1).head<3>() = back.cross(right);
  m.col(2).head<3>() = back;
  m.col(3).head<3>() = eye;
  return m;
}

}  // namespace

View make_view(const SceneCamera& camera, int width, int height, const Vec2f& offset_px) {
  const float aspect =
      camera.aspect > 0 ? camera.aspect : static_cast<float>(width) / static_cast<float>(height);
  const float tan_y = std::tan(camera.yfov_rad / 2);
  const float tan_x = tan_y * aspect;
  const Mat4f camera_from_world = camera.world_from_camera.inverse();
  // A sample at +offset sees what lies there: the picture moves the other way.
  const float shift_x = -2 * offset_px.x() / static_cast<float>(width);
  const float shift_y = -2 * offset_px.y() / static_cast<float>(height);
  Mat4f projection = Mat4f::Zero();
  projection(0, 0) = 1 / tan_x;
  projection(1, 1) = 1 / tan_y;
  projection(0, 2) = -shift_x;
  projection(1, 2) = -shift_y;
  projection(3, 2) = -1;
  // glTF 2.0, 3.10.3.3 and 3.10.3.4 (infinite).
  const bool infinite = std::isinf(camera.far_m);
  const float n = camera.near_m;
  projection(2, 2) = infinite ? -1 : (camera.far_m + n) / (n - camera.far_m);
  projection(2, 3) = infinite ? -2 * n : 2 * camera.far_m * n / (n - camera.far_m);
  View view;
  view.clip_from_world = projection * camera_from_world;
  view.eye = camera.world_from_camera.col(3).head<3>();
  view.right = camera.world_from_camera.col(0).head<3>() * tan_x;
  view.up = camera.world_from_camera.col(1).head<3>() * tan_y;
  view.forward = -camera.world_from_camera.col(2).head<3>() - view.right * shift_x - view.up * shift_y;
  return view;
}

SceneCamera fitted_camera(const Scene& scene) {
  const Box box = bounds(scene);
  SceneCamera camera;
  camera.name = "fitted";
  camera.yfov_rad = 0.7f;
  // The bounding sphere fills a square picture: its radius over the sine of half the field.
  const float distance = box.radius() / std::sin(camera.yfov_rad / 2);
  const Vec3f back = Vec3f(0.35f, 0.5f, 1).normalized();
  camera.world_from_camera = look_at(box.centre() + distance * back, back);
  camera.near_m = distance / 100;
  return camera;
}

Orbit::Orbit(const SceneCamera& start, const Scene& scene) {
  const Box box = bounds(scene);
  const Vec3f eye = start.world_from_camera.col(3).head<3>();
  const Vec3f back = start.world_from_camera.col(2).head<3>();
  distance_ = std::max((eye - box.centre()).dot(back), box.radius() / 100);
  // So far away that nothing of the scene is left to see.
  farthest_ = 1e3f * std::max(distance_, box.radius());
  start_at(start);
}

void Orbit::start_at(const SceneCamera& camera) {
  camera_ = camera;
  const Vec3f eye = camera.world_from_camera.col(3).head<3>();
  const Vec3f back = camera.world_from_camera.col(2).head<3>();
  target_ = eye - distance_ * back;
  azimuth_rad_ = std::atan2(back.x(), back.z());
  elevation_rad_ = std::asin(std::clamp(back.y(), -1.0f, 1.0f));
}

void Orbit::turn(float right_rad, float up_rad) {
  azimuth_rad_ += right_rad;
  // Short of the poles, where the horizon would lose its direction.
  elevation_rad_ = std::clamp(elevation_rad_ + up_rad, -1.5f, 1.5f);
  update();
}

void Orbit::zoom(float factor) {
  distance_ = std::clamp(distance_ * factor, camera_.near_m, farthest_);
  update();
}

void Orbit::slide(float right, float up) {
  target_ += distance_ * (right * camera_.world_from_camera.col(0).head<3>() +
                          up * camera_.world_from_camera.col(1).head<3>());
  update();
}

void Orbit::update() {
  const Vec3f back(std::cos(elevation_rad_) * std::sin(azimuth_rad_), std::sin(elevation_rad_),
                   std::cos(elevation_rad_) * std::cos(azimuth_rad_));
  camera_.world_from_camera = look_at(target_ + distance_ * back, back);
}

}  // namespace lightwell::render
