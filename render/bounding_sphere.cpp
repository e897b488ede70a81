// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/bounding_sphere.h"

#include <algorithm>
#include <vector>

namespace lightwell::render {
namespace {

struct Farthest {
  std::size_t index = 0;
  float distance = 0;
};

Farthest farthest(std::span<const Vec3f> points, const Vec3f& from) {
  std::size_t best = 0;
  float best_squared = -1;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float squared = (points[i] - from).squaredNorm();
    if (squared > best_squared) best_squared = squared, best = i;
  }
  return {best, (points[best] - from).norm()};
}

// Of few points. The centre walks toward the farthest by 1/(i+1): after i steps the radius is within 1/i of the
// smallest, or nearly so.
Sphere sphere_of(std::span<const Vec3f> core) {
  constexpr int kSteps = 400;
  Vec3f centre = core[0];
  for (int i = 1; i <= kSteps; ++i)
    centre += (core[farthest(core, centre).index] - centre) / static_cast<float>(i + 1);
  return {centre, farthest(core, centre).distance};
}

}  // namespace

Sphere bounding_sphere(std::span<const Vec3f> points) {
  if (points.empty()) return {};
  // A few points hold the sphere; the farthest one outside joins them until none is outside by much.
  constexpr int kMostCorePoints = 64;
  constexpr float kOutside = 1.002f;
  std::vector<Vec3f> core = {points[0]};
  Sphere sphere{points[0], 0};
  Farthest outermost = farthest(points, sphere.centre);
  for (int i = 1; i < kMostCorePoints && outermost.distance > kOutside * sphere.radius; ++i) {
    core.push_back(points[outermost.index]);
    sphere = sphere_of(core);
    outermost = farthest(points, sphere.centre);
  }
  // Rounding in the distance; a single point still needs a frustum of some size, which its coordinates can resolve.
  sphere.radius = std::max({outermost.distance * (1 + 1e-5f), 1e-6f * sphere.centre.norm(), 1e-12f});
  return sphere;
}

}  // namespace lightwell::render
