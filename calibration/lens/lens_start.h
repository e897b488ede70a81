// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calibration/lens/correspondences.h"
#include "lighting/lens.h"

namespace lightwell::calibration {

// Places where the distortion may be centred, most likely first, from the views alone: a point of the target
// lies on the line from the centre through its pixel, whatever the lens does along that line, so the centre
// is the epipole of the views' radial fundamental matrices (Hartley and Kang 2007, section 3.1). The middle of
// the image is the last of them.
std::vector<Vec2d> distortion_centers(const TargetViews& target_views);

// Lenses to start an adjustment from, best first, without any guess of the focal length: all focal lengths and
// the usual projections (equidistant, stereographic, equisolid, orthographic) around all centres, ranked by how
// well a target seen through them stays a target.
std::vector<Lens> lens_starts(const TargetViews& target_views, std::size_t count);

}  // namespace lightwell::calibration
