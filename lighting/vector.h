// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace lightwell {

using Vec2d = Eigen::Vector2d;
using Vec3f = Eigen::Vector3f;
using Vec3d = Eigen::Vector3d;

// Linear Rec. 709, D65. Radiance in cd/m² or illuminance in lux, as the name beside it says.
using Rgb = Eigen::Array3f;
using Rgbd = Eigen::Array3d;

inline constexpr double kPi = 3.14159265358979323846;

// Rec. 709 luminance of linear RGB (ITU-R BT.709-6, item 3.2).
inline float luminance(const Rgb& c) {
  return 0.2126f * c[0] + 0.7152f * c[1] + 0.0722f * c[2];
}
inline double luminance(const Rgbd& c) {
  return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
}

}  // namespace lightwell
