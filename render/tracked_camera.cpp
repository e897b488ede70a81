// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/tracked_camera.h"

#include <cmath>

namespace lightwell::render {

SceneCamera tracked_camera(const TrackedCamera& tracked, const SceneCamera& camera) {
  SceneCamera result = camera;
  const ProbePose pose = pose_from_tracked(tracked);
  result.world_from_camera = Mat4f::Identity();
  result.world_from_camera.topLeftCorner<3, 3>() = pose.world_from_probe.toRotationMatrix().cast<float>();
  result.world_from_camera.topRightCorner<3, 1>() = pose.position_m.cast<float>();
  if (tracked.focal_length_mm && tracked.sensor_height_mm)
    result.yfov_rad =
        static_cast<float>(2 * std::atan(*tracked.sensor_height_mm / (2 * *tracked.focal_length_mm)));
  return result;
}

}  // namespace lightwell::render
