// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lighting/result.h"
#include "lighting/vector.h"

namespace lightwell {

// The zenith in the camera's frame (x right, y down in the image, z along the axis), a unit vector, from what an
// accelerometer at rest reads there: it feels the push of the floor, so its reading points up. Any unit, any length.
// bad_input for a reading that is not finite, that is next to nothing (free fall, or a dead sensor), or where the camera
// looks straight down: check_zenith.
Result<Vec3d> zenith_from_accelerometer(const Vec3d& reading);

// A unit vector, not straight behind the camera, where nothing says which azimuth the top of the image has.
Status check_zenith(const Vec3d& zenith);

// Turns directions of the camera into those of the world, zenith into +Y. The frame is that of a camera that looks up
// (x → +X, y → −Z, z → +Y), turned about a horizontal axis by the least angle that brings the zenith to +Y: azimuths
// stay as near as they can to those of the untilted camera. zenith: as check_zenith asks for.
Eigen::Matrix3d world_from_camera_rotation(const Vec3d& zenith);

}  // namespace lightwell
