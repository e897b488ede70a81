// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/lens/field_coverage.h"

#include <algorithm>
#include <cmath>

namespace lightwell::calibration {

double azimuth_rad(const Vec3d& camera_direction) {
  const double angle = std::atan2(camera_direction.x(), -camera_direction.y());
  return angle < 0 ? angle + 2 * kPi : angle;
}

FieldCoverage field_coverage(const LensCalibration& calibration, const TargetViews& target_views) {
  FieldCoverage out;
  const double field_deg = calibration.lens.max_theta_rad * 180 / kPi;
  const auto rings = static_cast<std::size_t>(std::lround(field_deg / out.ring_deg));
  out.points.assign(std::max<std::size_t>(1, rings), std::vector<std::size_t>(FieldCoverage::kSectors, 0));
  for (std::size_t v = 0; v < calibration.views.size(); ++v) {
    const ViewResult& view = calibration.views[v];
    if (!view.used) continue;
    const auto& points = target_views.views[v].points;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (std::binary_search(view.rejected.begin(), view.rejected.end(), i)) continue;
      const Vec3d d = calibration.lens.unproject(points[i].pixel);
      const double theta_deg = std::atan2(d.head<2>().norm(), d.z()) * 180 / kPi;
      const auto ring = std::min(out.points.size() - 1, static_cast<std::size_t>(theta_deg / out.ring_deg));
      const auto sector = static_cast<std::size_t>(azimuth_rad(d) / (2 * kPi) * FieldCoverage::kSectors);
      ++out.points[ring][std::min(sector, FieldCoverage::kSectors - 1)];
    }
  }
  return out;
}

}  // namespace lightwell::calibration
