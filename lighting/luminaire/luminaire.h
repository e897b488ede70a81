// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "lighting/luminaire/far_field.h"
#include "lighting/luminaire/near_field.h"

namespace lightwell {

// A lamp in its frame: what its file tells, near, far, or both; their light adds up. One of them at least is there.
struct Luminaire {
  std::string name;
  std::optional<NearField> near;
  std::optional<FarField>
      far;  // about the middle of the sampling plane's height: (0, 0, z_m), or the frame's origin
};

// Where the far field's point is.
Vec3d far_centre(const Luminaire& lamp);
// Of a surface at a point of the lamp's frame; normal: unit. Lux, 0 or more.
Rgbd illuminance(const Luminaire& lamp, const Vec3d& point, const Vec3d& normal);
Rgbd luminous_flux(const Luminaire& lamp);  // lm

}  // namespace lightwell
