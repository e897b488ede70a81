// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "calibration/lens/target_pose.h"
#include "calibration/lens/target_shape.h"
#include "lighting/lens.h"

namespace lightwell::calibration {

// A view as the adjustment sees it: its pose, and the points that count.
struct PosedView {
  TargetPose pose;
  std::vector<Correspondence> points;
};

// What is solved for; all else keeps its value.
struct LensFreedom {
  int coefficients = 4;  // k1 … , 0 to 4; those beyond are held at 0
  bool aspect = true;    // fy / fx; held at 1
  bool center = true;
};

struct AdjustmentOptions {
  LensFreedom freedom;
  // Cauchy's loss of this scale on a point's error; infinity: least squares.
  double cauchy_px = std::numeric_limits<double>::infinity();
  int iterations = 50;
  double tolerance = 1e-10;  // smallest relative change of the sum that is worth another iteration
  bool walls = true;         // keep θd increasing over the angles that the points use
};

// The least slope of θd that the walls allow: a fiftieth of the centre's, well above what check(Lens) refuses.
inline constexpr double kLeastSlope = 0.02;

// Bundle adjustment: the lens and all poses that make Σ loss(|projection − pixel|²) smallest. Returns Σ |projection − pixel|² (not the loss), or NaN
// where the solver finds no number. shape: solved for too where given; points stay those of the square board.
double adjust(Lens& lens, std::vector<PosedView>& views, const AdjustmentOptions& options,
              TargetShape* shape = nullptr);

// Covariance of fx, fy, cx, cy, k1 … k4 for pixel noise of standard deviation noise_px a coordinate, poses
// marginalised, and the board's shape where `shape` is given (points are then those of the shaped board). Zero rows for what is held; fx and fy vary together where the aspect is held. Nothing where
// the views do not determine the lens.
std::optional<Eigen::Matrix<double, 8, 8>> lens_covariance(const Lens& lens,
                                                           const std::vector<PosedView>& views,
                                                           const LensFreedom& freedom, double noise_px,
                                                           const TargetShape* shape = nullptr);

// The angle up to `to_rad` where θd grows least, and its slope there.
struct LeastGrowth {
  double theta_rad = 0;
  double slope = 1;
};
LeastGrowth least_growth(const Lens& lens, double to_rad);

// Largest angle off axis of the views' points, radians.
double largest_theta_rad(const std::vector<PosedView>& views);

}  // namespace lightwell::calibration
