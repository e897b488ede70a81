// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/evaluation/evaluate.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lightwell {
namespace {

// A set's lights in double, once.
struct Light {
  Vec3d direction;
  Rgbd illuminance;
};
std::vector<Light> in_double(const LightSet& set) {
  std::vector<Light> lights;
  for (const DirectionalLight& light : set.lights)
    lights.push_back({light.direction.cast<double>(), light.illuminance.cast<double>()});
  return lights;
}

}  // namespace

double relative_rmse(const std::vector<Rgbd>& values, const std::vector<Rgbd>& reference) {
  double largest = 0;
  for (const Rgbd& r : reference) largest = std::max(largest, r.maxCoeff());
  const double scale = largest > 0 ? 1 / largest : 1;  // squares of 1e-200 would vanish
  double difference = 0;
  double norm = 0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    difference += ((values[i] - reference[i]) * scale).square().sum();
    norm += (reference[i] * scale).square().sum();
  }
  if (difference == 0) return 0;
  return norm > 0 ? std::sqrt(difference / norm) : std::numeric_limits<double>::infinity();
}

std::vector<Rgbd> irradiance_of_lights(const LightSet& set) {
  const std::vector<Light> lights = in_double(set);
  std::vector<Rgbd> values;
  for (const Vec3d& normal : evaluation_normals()) {
    Rgbd sum = set.ambient.cast<double>() * kPi;
    for (const Light& light : lights) {
      const double cosine = normal.dot(light.direction);
      if (cosine > 0) sum += light.illuminance * cosine;
    }
    values.push_back(sum);
  }
  return values;
}

std::vector<Rgbd> shadow_of_lights(const LightSet& set, Occluder occluder) {
  std::vector<Light> lights = in_double(set);
  std::erase_if(lights, [](const Light& light) { return light.direction.y() <= 0; });
  for (Light& light : lights) light.illuminance *= light.direction.y();
  const Rgbd ambient = set.ambient.cast<double>();
  const bool has_ambient = (ambient != 0).any();
  std::vector<Rgbd> values;
  for (const Vec3d& point : evaluation_ground()) {
    Rgbd sum = Rgbd::Zero();
    if (has_ambient) sum = ambient * (kPi - hidden_of_uniform_sky(occluder, point));
    if (occluder == Occluder::sphere) {  // hides() with what depends on the point alone taken out of the loop
      const double tangent = point.norm();
      const Vec3d to_centre = Vec3d::UnitY() - point;
      for (const Light& light : lights)
        if (light.direction.dot(to_centre) <= tangent) sum += light.illuminance;
    } else {
      for (const Light& light : lights)
        if (!hides(occluder, point, light.direction)) sum += light.illuminance;
    }
    values.push_back(sum);
  }
  return values;
}

LightEvaluator::LightEvaluator(const PolarMap& map, Occluder occluder)
    : LightEvaluator(EvaluationGeometry(map.grid, occluder), map) {}

LightEvaluator::LightEvaluator(const EvaluationGeometry& geometry, const PolarMap& map)
    : occluder_(geometry.occluder()) {
  geometry.irradiance(map, map_irradiance_);
  geometry.shadow(map, map_shadow_);
}

LightError LightEvaluator::error(const LightSet& set) const {
  return {relative_rmse(irradiance_of_lights(set), map_irradiance_),
          relative_rmse(shadow_of_lights(set, occluder_), map_shadow_)};
}

}  // namespace lightwell
