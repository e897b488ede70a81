// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/luminaire/luminaire.h"

namespace lightwell {

Vec3d far_centre(const Luminaire& lamp) {
  return {0, 0, lamp.near ? lamp.near->intensity.planes.z_m : 0.0};
}

Rgbd illuminance(const Luminaire& lamp, const Vec3d& point, const Vec3d& normal) {
  Rgbd sum = Rgbd::Zero();
  if (lamp.near) sum += illuminance(*lamp.near, point, normal);
  if (lamp.far) sum += illuminance(*lamp.far, Vec3d(point - far_centre(lamp)), normal);
  return sum;
}

Rgbd luminous_flux(const Luminaire& lamp) {
  Rgbd sum = Rgbd::Zero();
  if (lamp.near) sum += luminous_flux(*lamp.near);
  if (lamp.far) sum += luminous_flux(*lamp.far);
  return sum;
}

}  // namespace lightwell
