// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "lighting/light_set.h"
#include "lighting/polar_map.h"

namespace lightwell::bench {

// The peer: importance sampling of an environment as renderers commonly write it (Pharr and Humphreys 2004;
// Distribution2D): cumulative sums in double over every row and over the rows, binary search, one light at a
// time.
class RowColumnInversion {
 public:
  explicit RowColumnInversion(const PolarGrid& grid)
      : grid_(grid),
        conditional_(static_cast<std::size_t>(grid.rings) * (static_cast<std::size_t>(grid.sectors) + 1)),
        marginal_(static_cast<std::size_t>(grid.rings) + 1) {}

  void build(const PolarMap& map) {
    const auto sectors = static_cast<std::size_t>(grid_.sectors);
    marginal_[0] = 0;
    for (std::size_t k = 0; k + 1 < marginal_.size(); ++k) {
      double* row = conditional_.data() + k * (sectors + 1);
      row[0] = 0;
      for (std::size_t s = 0; s < sectors; ++s) {
        const std::size_t bin = k * sectors + s;
        const Rgbd radiance = map.rgb(bin).cast<double>();
        row[s + 1] = row[s] + luminance(radiance) * static_cast<double>(map.solid_angle_sr[bin]);
      }
      marginal_[k + 1] = marginal_[k] + row[sectors];
    }
  }

  [[nodiscard]] DirectionalLight sample(const PolarMap& map, const Vec2d& u, std::size_t count) const {
    const auto sectors = static_cast<std::size_t>(grid_.sectors);
    const double t = u.x() * marginal_.back();
    const std::size_t k = place(marginal_.data(), marginal_.size(), t);
    const double* row = conditional_.data() + k * (sectors + 1);
    const double f = part(marginal_.data(), k, t);
    const double c = u.y() * row[sectors];
    const std::size_t s = place(row, sectors + 1, c);
    const double cos_inner = std::cos(grid_.ring_edge_rad(static_cast<int>(k)));
    const double cos_outer = std::cos(grid_.ring_edge_rad(static_cast<int>(k) + 1));
    const double theta = std::acos(cos_inner + f * (cos_outer - cos_inner));
    const double lambda = 2 * kPi * (static_cast<double>(s) + part(row, s, c)) / static_cast<double>(sectors);
    const Rgbd radiance = map.rgb(k * sectors + s).cast<double>();
    const double power = marginal_.back() / static_cast<double>(count);
    DirectionalLight light;
    light.direction = direction_from_spherical({theta, lambda}).cast<float>();
    light.illuminance = (radiance * (power / std::max(luminance(radiance), 1e-300))).cast<float>();
    return light;
  }

 private:
  static std::size_t place(const double* cdf, std::size_t size, double value) {
    const auto above = static_cast<std::size_t>(std::upper_bound(cdf, cdf + size, value) - cdf);
    return std::clamp<std::size_t>(above, 1, size - 1) - 1;
  }
  static double part(const double* cdf, std::size_t i, double value) {
    const double width = cdf[i + 1] - cdf[i];
    return width > 0 ? std::clamp((value - cdf[i]) / width, 0.0, 1.0) : 0.5;
  }

  PolarGrid grid_;
  std::vector<double> conditional_;  // [rings][sectors + 1]
  std::vector<double> marginal_;     // [rings + 1]
};

}  // namespace lightwell::bench
