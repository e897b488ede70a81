// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "lighting/result.h"
#include "lighting/vector.h"

namespace lightwell {

// Kannala–Brandt fisheye: θd = θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸); pixel = center + focal · θd · (cos φ, sin φ).
// Kannala and Brandt 2006, with OpenCV's naming. Valid beyond 90° off axis, up to max_theta_rad.
//
// Camera frame: x right, y down in the image, z along the optical axis; (0,0) is the centre of the top-left pixel.
// World frame for a camera that looks up, and where gravity is unknown: x_cam → +X, y_cam → −Z, z_cam → +Y, so that the
// top of the image is azimuth 0 (+Z), its right side azimuth 90° (+X). A tilted one: lighting/orientation.h.
struct Lens {
  std::array<int, 2> image_size = {640, 480};  // width, height
  Vec2d focal = {150, 150};                    // pixels per radian
  Vec2d center = {319.5, 239.5};
  std::array<double, 4> k = {0, 0, 0, 0};
  double max_theta_rad = kPi / 2;
  Vec3d zenith = Vec3d::UnitZ();  // in the camera frame, unit; the axis where gravity is unknown

  // direction: camera frame, any non-zero length, at most max_theta_rad off axis for a meaningful answer
  [[nodiscard]] Vec2d project(const Vec3d& direction) const;
  // Unit direction in the camera frame; Newton on θd, round trip < 1e-9 rad inside max_theta_rad. Beyond the field the
  // angle is that of the extrapolated polynomial, or of its tangent at the edge, clamped to π.
  [[nodiscard]] Vec3d unproject(const Vec2d& pixel) const;
  // Zenith angle off axis of a pixel, radians.
  [[nodiscard]] double theta_rad(const Vec2d& pixel) const;
  // Solid angle of the pixel square around `pixel`, sr, exact to quadrature (the circle sums to the analytic cap
  // within 1e-6). Pixels outside max_theta_rad: 0; pixels that the border crosses: the part inside.
  [[nodiscard]] double pixel_solid_angle_sr(const Vec2d& pixel) const;
};

// How a projection moves with the lens and with the direction: what calibration is made of.
struct LensJacobian {
  Vec2d pixel;
  Eigen::Matrix<double, 2, 8> dpixel_dlens;       // by fx, fy, cx, cy, k1 … k4
  Eigen::Matrix<double, 2, 3> dpixel_ddirection;  // by the direction, of any length; 0 straight behind
};
LensJacobian project_with_jacobian(const Lens& lens, const Vec3d& direction);

// Of a camera that looks straight up.
inline Vec3d world_from_camera(const Vec3d& d) {
  return {d.x(), d.z(), -d.y()};
}
inline Vec3d camera_from_world(const Vec3d& d) {
  return {d.x(), -d.z(), d.y()};
}

// Sizes, finiteness, positive focal length, θd increasing over the field, a zenith; the error names the field, value and range.
Status check(const Lens& lens);

// Largest field over which the projection grows as check asks for, at most π; whatever max_theta_rad is.
double increasing_to_rad(const Lens& lens);

}  // namespace lightwell
