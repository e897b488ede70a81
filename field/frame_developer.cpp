// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "field/frame_developer.h"

#include <algorithm>
#include <cmath>

#include "lighting/orientation.h"

namespace lightwell {
namespace {

bool is_turned(const Eigen::Quaterniond& q) {
  constexpr double kLeast = 1e-6;  // half an angle: a thousandth of a bin
  return q.vec().norm() > kLeast;
}

// The bins that lie within the lens's field and on the sensor.
std::vector<bool> seen_bins(const Lens& lens, const PolarGrid& grid) {
  const Eigen::Matrix3d camera_from_probe = world_from_camera_rotation(lens.zenith).transpose();
  const auto [width, height] = lens.image_size;
  std::vector<bool> seen(grid.size());
  for (int ring = 0; ring < grid.rings; ++ring)
    for (int sector = 0; sector < grid.sectors; ++sector) {
      const Vec3d d = camera_from_probe * grid.bin_direction(ring, sector);
      const Vec2d pixel = lens.project(d);
      seen[static_cast<std::size_t>(ring) * static_cast<std::size_t>(grid.sectors) +
           static_cast<std::size_t>(sector)] = std::atan2(d.head<2>().norm(), d.z()) <= lens.max_theta_rad &&
                                               pixel.x() >= -0.5 && pixel.y() >= -0.5 &&
                                               pixel.x() <= width - 0.5 && pixel.y() <= height - 0.5;
    }
  return seen;
}

}  // namespace

Result<FrameDeveloper> FrameDeveloper::create(const Calibration& calibration, const FrameFormat& format,
                                              int height) {
  verify_bug(height >= 2 && height <= 4096, "height of developed pictures out of range");
  const double ring_rad = kPi / height;
  const Lens& lens = calibration.lens;
  const double tilt_rad = std::acos(std::clamp(lens.zenith.z(), -1.0, 1.0));
  const double theta_max_rad = std::min(kPi, lens.max_theta_rad + tilt_rad);
  PolarGrid grid;
  grid.rings = std::min(height, static_cast<int>(std::ceil(theta_max_rad / ring_rad - 1e-9)));
  grid.sectors = 2 * height;
  grid.theta_max_rad = grid.rings * ring_rad;
  auto radiometer = Radiometer::create(calibration, format, {.grid = grid, .isa = {}});
  if (!radiometer) return radiometer.error();
  return FrameDeveloper(*std::move(radiometer), WorldPicture(grid, seen_bins(lens, grid)), theta_max_rad);
}

FrameDeveloper::Developed FrameDeveloper::develop(std::span<const std::byte> codes, double exposure_us,
                                                  const Eigen::Quaterniond& world_from_probe) {
  radiometer_.develop(codes, exposure_us, map_);
  Developed out;
  out.clipped_pixels = map_.clipped_pixels;
  if (is_turned(world_from_probe))
    picture_.paint(map_, world_from_probe, out.picture);
  else
    picture_.paint_upright(map_, out.picture);
  return out;
}

}  // namespace lightwell
