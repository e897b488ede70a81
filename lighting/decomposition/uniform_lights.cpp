// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/uniform_lights.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "lighting/spherical_cap.h"

namespace lightwell {
namespace {

// Zones from the zenith down, each of a whole number of cells.
class EqualAreaCells {
 public:
  EqualAreaCells(double theta_max_rad, int count) : measure_(cap_measure(theta_max_rad)), count_(count) {
    const double cell_side = std::sqrt(2 * kPi * measure_ / count);
    const int zones = std::clamp(static_cast<int>(std::lround(theta_max_rad / cell_side)), 1, count);
    begin_.push_back(0);
    for (int zone = 1; zone < zones; ++zone) {
      const double share = cap_measure(theta_max_rad * zone / zones) / measure_;
      const int least = begin_.back() + 1;
      begin_.push_back(
          std::clamp(static_cast<int>(std::lround(share * count)), least, count - (zones - zone)));
    }
    begin_.push_back(count);
  }

  [[nodiscard]] int cell(double theta_rad, double turn) const {
    const double position = cap_measure(theta_rad) / measure_ * count_;
    const auto after = std::upper_bound(begin_.begin() + 1, begin_.end() - 1, position,
                                        [](double value, int begin) { return value < begin; });
    const int first = *(after - 1);
    const int cells = *after - first;
    return first + std::clamp(static_cast<int>((turn - std::floor(turn)) * cells), 0, cells - 1);
  }

  [[nodiscard]] Spherical middle(int cell) const {
    const auto after = std::upper_bound(begin_.begin(), begin_.end(), cell);
    const int first = *(after - 1);
    const double measure = measure_ * (first + *after) / (2.0 * count_);
    const double lambda = 2 * kPi * (cell - first + 0.5) / (*after - first);
    return {2 * std::asin(std::sqrt(std::min(1.0, measure / 2))), lambda};
  }

 private:
  double measure_;
  int count_;
  std::vector<int> begin_;  // first cell of each zone, and count
};

std::uint32_t reversed_bits(std::uint32_t v) {
  std::uint32_t r = 0;
  for (int bit = 0; bit < 32; ++bit) r |= (v >> bit & 1u) << (31 - bit);
  return r;
}

}  // namespace

std::vector<DirectionalLight> uniform_lights(const PolarMap& map, int count, std::uint32_t seed) {
  const PolarGrid& grid = map.grid;
  const EqualAreaCells cells(grid.theta_max_rad, count);
  const double offset = reversed_bits(seed) * 0x1p-32;  // turns
  std::vector<Rgbd> power(static_cast<std::size_t>(count), Rgbd::Zero());
  std::size_t bin = 0;
  for (int ring = 0; ring < grid.rings; ++ring)
    for (int sector = 0; sector < grid.sectors; ++sector, ++bin) {
      const double theta = grid.theta_max_rad * (ring + 0.5) / grid.rings;
      const int cell = cells.cell(theta, (sector + 0.5) / grid.sectors - offset);
      power[static_cast<std::size_t>(cell)] +=
          map.rgb(bin).cast<double>() * static_cast<double>(map.solid_angle_sr[bin]);
    }
  std::vector<std::uint32_t> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0u);
  const int shift = 32 - static_cast<int>(std::bit_width(static_cast<unsigned>(count) - 1u));
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return shift >= 32 ? a < b : reversed_bits(a) >> shift < reversed_bits(b) >> shift;
  });
  std::vector<DirectionalLight> lights;
  for (const std::uint32_t cell : order) {
    Spherical middle = cells.middle(static_cast<int>(cell));
    middle.lambda_rad += 2 * kPi * offset;
    DirectionalLight light;
    light.direction = direction_from_spherical(middle).cast<float>();
    light.illuminance = power[cell].cast<float>();
    light.id = cell;
    lights.push_back(light);
  }
  return lights;
}

std::vector<DirectionalLight> dark_lights(const PolarGrid& grid, int count) {
  const EqualAreaCells cells(grid.theta_max_rad, count);
  std::vector<DirectionalLight> lights(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < lights.size(); ++i) {
    lights[i].direction = direction_from_spherical(cells.middle(static_cast<int>(i))).cast<float>();
  }
  return lights;
}

}  // namespace lightwell
