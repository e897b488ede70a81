// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/stage_truth.h"

#include <algorithm>
#include <cmath>

#include "daemon/simulator/walk_stage.h"
#include "lighting/direction.h"

namespace lightwell::bench {
namespace {

constexpr int kCorners = 17;  // along each side of the stage: 10 cm
constexpr int kRows = 180;    // of directions from the zenith to the horizon
constexpr int kAround = 4 * kRows;

double corner(int i) {
  return simulator::kWalkHalf_m * (2.0 * i / (kCorners - 1) - 1);
}

Rgbd integrate_walls(const Vec3d& at) {
  Rgbd sum = Rgbd::Zero();
  const double step = kPi / 2 / kRows;
  for (int i = 0; i < kRows; ++i) {
    const double theta = (i + 0.5) * step;
    // ∫ cos θ sin θ dθ over the row.
    const double weight =
        (std::pow(std::sin((i + 1) * step), 2) - std::pow(std::sin(i * step), 2)) / 2 * 2 * kPi / kAround;
    for (int j = 0; j < kAround; ++j)
      sum += weight * simulator::stage_wall_radiance(
                          at, direction_from_spherical({theta, 2 * kPi * (j + 0.5) / kAround}));
  }
  return sum;
}

}  // namespace

StageTruth::StageTruth() {
  for (int j = 0; j < kCorners; ++j)
    for (int i = 0; i < kCorners; ++i) walls_.push_back(integrate_walls({corner(i), 0, corner(j)}));
}

Rgbd StageTruth::of_walls(double x, double z) const {
  const auto along = [](double v) {
    return std::clamp((v / simulator::kWalkHalf_m + 1) / 2 * (kCorners - 1), 0.0, kCorners - 1 - 1e-9);
  };
  const double u = along(x), v = along(z);
  const auto i = static_cast<std::size_t>(u), j = static_cast<std::size_t>(v);
  const double fu = u - static_cast<double>(i), fv = v - static_cast<double>(j);
  const auto at = [&](std::size_t a, std::size_t b) { return walls_[b * kCorners + a]; };
  return (1 - fv) * ((1 - fu) * at(i, j) + fu * at(i + 1, j)) +
         fv * ((1 - fu) * at(i, j + 1) + fu * at(i + 1, j + 1));
}

Rgbd StageTruth::irradiance(double x, double z) const {
  Rgbd sum = of_walls(x, z);
  for (const simulator::DiscLight& light : simulator::stage_lights({x, 0, z}))
    sum += light.illuminance * std::max(0.0, light.direction.y());
  return sum;
}

}  // namespace lightwell::bench
