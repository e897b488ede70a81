// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lighting/direction.h"
#include "lighting/vector.h"

namespace lightwell {

// Rings equal in zenith angle from the zenith to theta_max, sectors equal in azimuth from 0 to 2π.
// Bin (ring, sector) has index ring * sectors + sector; ring 0 touches the zenith.
struct PolarGrid {
  int rings = 90;
  int sectors = 360;
  double theta_max_rad = kPi / 2;

  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(rings) * static_cast<std::size_t>(sectors);
  }
  [[nodiscard]] double ring_edge_rad(int ring) const { return theta_max_rad * ring / rings; }
  // Exact: (cos θ0 − cos θ1) · 2π / sectors, written without cancellation near the pole.
  [[nodiscard]] double bin_solid_angle_sr(int ring) const {
    const double a = ring_edge_rad(ring);
    const double b = ring_edge_rad(ring + 1);
    return 2 * std::sin((a + b) / 2) * std::sin((b - a) / 2) * 2 * kPi / sectors;
  }
  [[nodiscard]] Vec3d bin_direction(int ring, int sector) const {
    return direction_from_spherical(
        {theta_max_rad * (ring + 0.5) / rings, 2 * kPi * (sector + 0.5) / sectors});
  }
  friend bool operator==(const PolarGrid&, const PolarGrid&) = default;
};

// A radiance map over a polar grid.
//
// radiance[c][bin] is the mean radiance in cd/m² over what was measured of the bin, and solid_angle_sr[bin] is how much
// that was: their product is the bin's illuminance (lux facing it) with nothing lost or invented. For a map binned from
// pixels the solid angle is the sum over the pixels of the bin, which differs from the bin's own by the pixels that
// straddle its border; over the map both sum to the same cap. Bins without a pixel carry their nearest pixel's radiance
// and solid angle 0.
struct PolarMap {
  PolarGrid grid;
  int channels = 1;             // 1: monochrome, meaning R = G = B; 3: linear Rec. 709
  std::vector<float> radiance;  // [channels][rings][sectors], cd/m², finite and ≥ 0
  // [channels][rings][sectors], largest pixel radiance of the bin, never below its mean. A pixel smaller than the bin's
  // largest counts in proportion: within 1 % inside the field, less for pixels that its border cuts. In colour, the
  // channels' own peaks through the camera's matrix.
  std::vector<float> peak;
  std::vector<float> solid_angle_sr;   // [rings][sectors], ≥ 0; the same for every frame of a camera
  std::vector<std::uint16_t> clipped;  // [rings][sectors], pixels of the bin at the top code
  std::uint32_t clipped_pixels = 0;    // over the field: the sum of clipped
  float coverage = 1;                  // measured part of the sphere, 0 to 1 (a full hemisphere is 0.5)

  // Allocates all planes, zero; solid_angle_sr is the grid's exact one, coverage the grid's.
  static PolarMap make(const PolarGrid& grid, int channels);

  [[nodiscard]] std::span<const float> plane(int channel) const {
    return std::span(radiance).subspan(static_cast<std::size_t>(channel) * grid.size(), grid.size());
  }
  [[nodiscard]] std::span<float> plane(int channel) {
    return std::span(radiance).subspan(static_cast<std::size_t>(channel) * grid.size(), grid.size());
  }
  [[nodiscard]] Rgb rgb(std::size_t bin) const {
    if (channels == 1) return Rgb::Constant(radiance[bin]);
    return {radiance[bin], radiance[grid.size() + bin], radiance[2 * grid.size() + bin]};
  }
};

// Sum of radiance × solid angle over the map: RGB lux summed over directions (no cosine). Accumulates in double.
Rgbd total_illuminance(const PolarMap& map);

}  // namespace lightwell
