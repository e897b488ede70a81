// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lighting/evaluation/evaluation_geometry.h"
#include "lighting/evaluation/occluder.h"
#include "lighting/light_set.h"
#include "lighting/polar_map.h"

namespace lightwell {

// How far a light set is from the map it stands for. Relative RMSE over all values and RGB, ‖lights − map‖ /
// ‖map‖; 0 where both are black, infinite where only the map is.
struct LightError {
  double irradiance_rel_rmse = 0;  // irradiance of 642 Fibonacci-distributed normals of the whole sphere
  double shadow_rel_rmse = 0;      // horizontal irradiance of the ground under an occluder
};

// Measures light sets against one map, every bin of the map being a light in the bin's centre.
// The ground is 64×64 points in the plane y = 0, spacing 6/64, centred; the occluder, by default a unit sphere,
// rests on its origin, visibility is exact. A set's ambient shines from the whole sphere, whatever the set's
// coverage.
class LightEvaluator {
 public:
  explicit LightEvaluator(const PolarMap& map, Occluder occluder = Occluder::sphere);
  // For frame after frame of one grid: the geometry is made once, and only read here.
  LightEvaluator(const EvaluationGeometry& geometry, const PolarMap& map);
  [[nodiscard]] LightError error(const LightSet& set) const;

  // What both sides are compared by: one value a normal, one a ground point (rows along z, columns along x).
  [[nodiscard]] const std::vector<Rgbd>& map_irradiance() const { return map_irradiance_; }
  [[nodiscard]] const std::vector<Rgbd>& map_shadow() const { return map_shadow_; }

 private:
  Occluder occluder_;
  std::vector<Rgbd> map_irradiance_;
  std::vector<Rgbd> map_shadow_;
};

// What the lights (and ambient) of a set give.
std::vector<Rgbd> irradiance_of_lights(const LightSet& set);
std::vector<Rgbd> shadow_of_lights(const LightSet& set, Occluder occluder = Occluder::sphere);

// ‖values − reference‖ / ‖reference‖ over all values and channels; 0 where both are black, infinite where only
// the reference is. Of one size; of any finite scale.
double relative_rmse(const std::vector<Rgbd>& values, const std::vector<Rgbd>& reference);

}  // namespace lightwell
