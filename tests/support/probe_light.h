// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>
#include <vector>

#include "lighting/fit/few_lights.h"
#include "lighting/fit/lambertian_probe.h"

// Light on a probe whose parts are known.
namespace lightwell::test {

struct KnownLight {
  Vec3d direction;
  Rgbd illuminance;
};

inline ProbeIrradiance probe_in(const std::vector<KnownLight>& lights, const Rgbd& ambient) {
  const ProbeNormals normals = probe_normals();
  ProbeIrradiance sum;
  for (int i = 0; i < kProbeNormals; ++i) {
    Rgbd value = ambient * kPi;
    for (const KnownLight& light : lights)
      value += light.illuminance * std::max(0.0, normals.col(i).dot(light.direction));
    sum.row(i) = value.transpose();
  }
  return sum;
}

inline Vec3d random_unit(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Vec3d(normal(random), normal(random), normal(random)).normalized();
}

// Lights of one to four times the least power and any colour, no two closer than apart_rad.
inline std::vector<KnownLight> random_lights(int count, double apart_rad, std::mt19937& random) {
  std::uniform_real_distribution<double> power(1, 4);
  std::vector<KnownLight> lights;
  while (static_cast<int>(lights.size()) < count) {
    const Vec3d d = random_unit(random);
    bool apart = true;
    for (const KnownLight& other : lights) apart = apart && d.dot(other.direction) < std::cos(apart_rad);
    if (apart) lights.push_back({d, {power(random), power(random), power(random)}});
  }
  return lights;
}

// How far the farthest light is from the fitted one that is nearest to it.
inline double farthest_rad(const std::vector<KnownLight>& lights, const FewLightsFit& fit) {
  double farthest = 0;
  for (const KnownLight& light : lights) {
    double nearest = kPi;
    for (int k = 0; k < fit.count; ++k) {
      const Vec3d& d = fit.lights[static_cast<std::size_t>(k)].direction;
      nearest = std::min(nearest, 2 * std::asin(std::min(1.0, (d - light.direction).norm() / 2)));
    }
    farthest = std::max(farthest, nearest);
  }
  return farthest;
}

}  // namespace lightwell::test
