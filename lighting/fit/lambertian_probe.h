// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "lighting/polar_map.h"

namespace lightwell {

// Faces of the probe: an icosahedron divided twice, as in the paper.
inline constexpr int kProbeNormals = 320;

// Irradiance of every face, lux, RGB: the radiance of a white Lambertian sphere times π.
using ProbeIrradiance = Eigen::Array<double, kProbeNormals, 3>;

// Unit normals of the faces, one a column. They come in opposite pairs: column i + 160 is −column i.
using ProbeNormals = Eigen::Matrix<double, 3, kProbeNormals>;
ProbeNormals probe_normals();

// A white Lambertian sphere in the light of a map: E_i = Σ_bins L Ω max(0, n_i·d), every bin a light in its centre.
//
// The sum is exact, not sampled. Along a ring the bins that a face sees are one interval of azimuth, so that differences
// of running sums give a ring in constant time; where the interval begins and ends depends on the grid alone and stands
// in a table. Rings that a face sees whole come as one sum, and the face opposite costs nothing, because max(0, x) −
// max(0, −x) = x makes its irradiance the first one's less n·Σ L Ω d.
// source: Madsen, Sørensen, Vittrup 2003, section 3.1, eqs. 1–3, whose sum lacks the solid angle Ω
class LambertianProbe {
 public:
  explicit LambertianProbe(const PolarGrid& grid);

  // map: of this grid; what is not finite and positive counts as 0. A map of the hemisphere lights the probe from there
  // only. Allocates nothing.
  void irradiance(const PolarMap& map, ProbeIrradiance& out) noexcept;
  // Of the last map: radiance × solid angle over all directions, lux.
  [[nodiscard]] const Rgbd& total_illuminance() const { return total_; }

  [[nodiscard]] const PolarGrid& grid() const { return grid_; }

 private:
  // The part of a ring that a face of the first half sees: sectors [first, last), and all of the ring besides where
  // the interval runs across the seam and last ≤ first.
  struct Interval {
    std::int16_t face;
    std::int16_t across_seam;  // 0 or 1
    std::int32_t first;
    std::int32_t last;
  };
  template <int kLanes>
  void sum(const PolarMap& map, ProbeIrradiance& out) noexcept;

  PolarGrid grid_;
  ProbeNormals normals_;
  std::vector<double> sin_theta_, cos_theta_;    // [rings], of the bins' centres
  std::vector<double> sin_lambda_, cos_lambda_;  // [sectors]
  std::vector<int> whole_rings_;                 // [160], rings from the zenith that the face sees whole
  std::vector<Interval> intervals_;              // of all rings, one after another
  std::vector<std::size_t> ring_intervals_;      // [rings + 1], where a ring's intervals begin
  std::vector<double> lights_;                   // one ring: [sectors][lanes], lux
  std::vector<double> running_;                  // one ring: [sectors + 1][flux, × sin λ, × cos λ][lanes]
  std::vector<double> rings_before_;             // [rings + 1][x, y, z][lanes]: Σ L Ω d of the rings above
  Rgbd total_ = Rgbd::Zero();
};

}  // namespace lightwell
