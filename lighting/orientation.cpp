// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/orientation.h"

#include <Eigen/Geometry>
#include <cmath>

#include "lighting/field_error.h"

namespace lightwell {

Result<Vec3d> zenith_from_accelerometer(const Vec3d& reading) {
  for (Eigen::Index i = 0; i < 3; ++i)
    if (!std::isfinite(reading[i]))
      return field_error("gravity[" + std::to_string(i) + "]", reading[i], "a finite number");
  const double length = reading.stableNorm();
  // A hundredth of the weakest unit in use, multiples of g: a sensor that rests is nowhere near.
  if (!(length > 0.01)) return field_error("gravity: length", length, "above 0.01, the sensor must rest");
  const Vec3d zenith = (reading / length).normalized();
  if (const Status status = check_zenith(zenith); !status) return status.error();
  return zenith;
}

Status check_zenith(const Vec3d& zenith) {
  const double length = zenith.norm();
  if (!(std::abs(length - 1) < 1e-6)) return field_error("zenith: length", length, "1, to a millionth");
  // Within half a degree of straight down a hand's tremor turns the azimuth all the way round.
  if (zenith.z() < -0.99996)
    return field_error("zenith[2]", zenith.z(), "at least -0.99996, the camera may not look straight down");
  return {};
}

Eigen::Matrix3d world_from_camera_rotation(const Vec3d& zenith) {
  Eigen::Matrix3d level;
  level << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  if (zenith == Vec3d::UnitZ()) return level;  // to the last bit
  return Eigen::Quaterniond::FromTwoVectors(level * zenith, Vec3d::UnitY()).normalized().toRotationMatrix() *
         level;
}

}  // namespace lightwell
