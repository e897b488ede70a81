// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/luminaire/far_projection.h"

#include <algorithm>

#include "lighting/result.h"

namespace lightwell {
namespace {

// From so far away that all sources lie in one direction.
double intensity_of(const NearField& near, const Vec3d& direction) {
  if (!(direction.z() < 0)) return 0;
  const LampPlanes& planes = near.intensity.planes;
  Rgbd sum = Rgbd::Zero();
  for (int v = 0; v < planes.positions[1]; ++v)
    for (int u = 0; u < planes.positions[0]; ++u)
      sum += near.intensity.at(u, v, planes.on_map(planes.position(u, v), direction));
  return std::max(luminance(sum), 0.0);
}

}  // namespace

FarField far_field_of(const Luminaire& lamp, const FarGrid& grid) {
  verify_bug(lamp.near.has_value() || lamp.far.has_value(), "a lamp without light");
  verify_bug(grid.planes >= 1 && grid.angles >= 2, "no angles");
  if (!lamp.near) return *lamp.far;
  FarField out;
  out.horizontal_deg.clear();
  for (int h = 0; h < grid.planes; ++h) out.horizontal_deg.push_back(360.0 * h / grid.planes);
  const bool backward = lamp.far.has_value() && luminous_flux(*lamp.far) > 0;
  for (int v = 0; v < grid.angles; ++v) {
    const double gamma_deg = 180.0 * v / (grid.angles - 1);
    if (backward || gamma_deg <= 90) out.vertical_deg.push_back(gamma_deg);
  }
  for (const double h : out.horizontal_deg)
    for (const double v : out.vertical_deg) {
      const Vec3d direction = photometric_direction(PhotometricSystem::c, {h, v});
      out.candela.push_back(intensity_of(*lamp.near, direction) +
                            (lamp.far ? intensity(*lamp.far, direction) : 0));
    }
  return out;
}

}  // namespace lightwell
