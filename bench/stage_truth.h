// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lighting/vector.h"

namespace lightwell::bench {

// The ground y = 0 of the simulated walk's stage (daemon/simulator/walk_stage.h): irradiance facing up, lux, by direct
// integration: lamps and lenses exactly, walls at every half degree.
class StageTruth {
 public:
  StageTruth();
  [[nodiscard]] Rgbd irradiance(double x, double z) const;

 private:
  [[nodiscard]] Rgbd of_walls(double x, double z) const;
  std::vector<Rgbd> walls_;  // at the corners of a grid: it changes little from place to place
};

}  // namespace lightwell::bench
