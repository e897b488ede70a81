// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "interface/tracking_pose.h"
#include "render/scene.h"

namespace lightwell::render {

// The scene's camera at the tracked place (pose_from_tracked). The field of view is 2 atan(h / 2f) where focal length f
// and sensor height h are known, else the camera's own.
SceneCamera tracked_camera(const TrackedCamera& tracked, const SceneCamera& camera);

}  // namespace lightwell::render
