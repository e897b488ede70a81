// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lighting/field/direction_bins.h"
#include "lighting/field/field_sums.h"
#include "lighting/field/moving_least_squares.h"
#include "lighting/field/nearest_samples.h"
#include "lighting/field/ray_consistency.h"
#include "lighting/field/support_choice.h"

namespace lightwell {

enum class FieldMethod {
  best,  // moving least squares, as wide as held-out rays say (lighting/field/moving_least_squares.h)
  low,   // the splat of Löw et al. 2009 (lighting/field/gaussian_splat.h)
};

// From what probes saw in one direction to that direction across the grid. Keeps scratch memory: one a thread.
class DirectionEstimator {
 public:
  // positions: of the probes, world, metres; at least one; must outlive this. support: for best (SupportChoice).
  DirectionEstimator(const FieldGrid& grid, std::span<const Vec3d> positions, FieldMethod method,
                     int support);

  // radiance: of each probe in this direction, NaN where it did not see it.
  void estimate(const MeasuredDirection& direction, std::span<const Rgb> radiance, FieldDirection& out);
  // The same rays, foretold from each other.
  void hold_out(const MeasuredDirection& direction, std::span<const Rgb> radiance, SupportChoice& choice);
  // Whether they are what the others foretell, over the support of this estimator.
  void check(const MeasuredDirection& direction, std::span<const Rgb> radiance, RayConsistency& consistency);

 private:
  ShearPlane project(const MeasuredDirection& direction, std::span<const Rgb> radiance);
  FieldGrid grid_;
  std::span<const Vec3d> positions_;
  FieldMethod method_;
  int support_;
  int pixels_a_cell_;
  std::vector<PlaneSample> samples_;
  NearestSamples nearest_;
  MovingLeastSquares fits_;
};

}  // namespace lightwell
