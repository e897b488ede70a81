// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lighting/polar_map.h"

namespace lightwell {

// The bins of a map that hold light, sorted into blocks of about 5° x 5°, so that what is near a place is found
// without looking at all of them.
struct LitBins {
  struct Block {
    std::size_t begin, end;  // of its bins
    Vec3d centre;            // unit
    double radius;           // largest distance (chord) of a bin from the centre
  };
  std::vector<Vec3d> direction;    // [bins] of the bins' centres
  std::vector<double> power;       // [bins] luminance × solid angle, as a share of the map's; sums to 1
  std::vector<std::uint32_t> bin;  // [bins] index in the map
  std::vector<Block> blocks;

  [[nodiscard]] std::size_t size() const { return bin.size(); }
  [[nodiscard]] bool empty() const { return bin.empty(); }
};

// map: radiance finite and ≥ 0. A black map has no lit bins.
LitBins lit_bins(const PolarMap& map);

// Illuminance of one bin of the map, lux facing it.
inline Rgbd bin_illuminance(const PolarMap& map, std::size_t bin) {
  return map.rgb(bin).cast<double>() * static_cast<double>(map.solid_angle_sr[bin]);
}

}  // namespace lightwell
