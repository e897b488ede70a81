// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/main_lights.h"

#include <algorithm>

#include "lighting/field/main_light_search.h"

namespace lightwell {
namespace {

constexpr std::size_t kMostAsked = 2000;  // points that are asked for directions
constexpr double kStep_rad = 0.07;        // half of what the directions that are tried lie apart

std::vector<Vec3d> find_directions(const Eigen::MatrixXd& points, int count, int degree) {
  std::vector<Vec3d> directions;
  const double total = total_of(points);
  if (!(total > 0)) return directions;
  while (static_cast<int>(directions.size()) < count) {
    const Eigen::MatrixXd residual = MainLightBasis(directions, degree).residual(points);
    const Vec3d next = brightest(residual, degree);
    if (illuminance_from(residual, next, degree) < kLeastMainLight * total) break;
    directions.push_back(next);
    // Each where it explains most of what the others leave.
    for (int round = 0; round < 2; ++round)
      for (std::size_t i = 0; i < directions.size(); ++i) {
        std::vector<Vec3d> others = directions;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
        directions[i] =
            refined(MainLightBasis(others, degree).residual(points), directions[i], degree, kStep_rad);
      }
  }
  return directions;
}

}  // namespace

const float* MainLights::plane(int light, int z, int channel, const FieldGrid& grid) const {
  const auto slab = static_cast<std::size_t>(grid.size[0]) * static_cast<std::size_t>(grid.size[1]);
  return &illuminance[((static_cast<std::size_t>(light) * static_cast<std::size_t>(grid.size[2]) +
                        static_cast<std::size_t>(z)) *
                           3 +
                       static_cast<std::size_t>(channel)) *
                      slab];
}

MainLights find_main_lights(const LightField& field, int count, const Vec3d& low, const Vec3d& high) {
  MainLights lights;
  if (count > 0)
    lights.directions = find_directions(points_in_box(field, low, high, kMostAsked),
                                        std::min(count, kMostMainLights), field.degree);
  lights.illuminance =
      illuminances(field, MainLightBasis(lights.directions, field.degree), lights.directions.size());
  return lights;
}

}  // namespace lightwell
