// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>

#include "calibration/lens/lens_adjustment.h"

namespace lightwell::calibration {
namespace {

constexpr int kViews = 10, kColumns = 7, kRows = 6;
constexpr double kPitchMm = 40;

// The problem of tests/reference/lens_least_squares.py, formula by formula.
TargetPose pose_of(int view) {
  const double azimuth = 2.4 * view, off_axis = 0.15 + 0.09 * view;
  const Vec3d sight(std::sin(off_axis) * std::cos(azimuth), std::sin(off_axis) * std::sin(azimuth),
                    std::cos(off_axis));
  TargetPose pose;
  pose.rotation = {0.5 * std::sin(1.7 * view), 0.5 * std::cos(2.3 * view), 0.3 * view};
  pose.translation_mm = 350 * sight - pose.camera_from_target() * Vec3d(120, 100, 0);
  return pose;
}

std::vector<PosedView> problem() {
  const Lens lens{{820, 780}, {300, 300.9}, {411, 387}, {-0.02, 0.004, -0.001, 0.0001}, kPi / 2};
  std::uint32_t state = 1;
  const auto noise = [&] {
    state = 1664525 * state + 1013904223;
    return 0.5 * (state / 4294967296.0 - 0.5);
  };
  std::vector<PosedView> views;
  for (int v = 0; v < kViews; ++v) {
    PosedView view{pose_of(v), {}};
    for (int r = 0; r < kRows; ++r)
      for (int c = 0; c < kColumns; ++c) {
        const Vec3d target(kPitchMm * c, kPitchMm * r, 0);
        Vec2d pixel = lens.project(view.pose.camera_from_target() * target + view.pose.translation_mm);
        pixel.x() += noise();
        pixel.y() += noise();
        view.points.push_back({target, pixel});
      }
    views.push_back(view);
  }
  return views;
}

// python3 tests/reference/lens_least_squares.py, SciPy's least_squares by MINPACK.
constexpr double kParameters[8] = {299.097623,     300.0520256,    411.335175,     387.1460878,
                                   -0.01894741413, 0.001435893069, 0.003148290084, -0.001763361498};
constexpr double kNoisePx = 0.1435985061;
constexpr double kCovariance[36] = {
    0.2277659,      0.22859044,     0.0076615862,   0.021542629,    -0.00036458617, 0.00033297394,
    -0.00035057291, 0.00011982323,  0.23401275,     0.010517745,    0.02141296,     -0.00033294383,
    0.00024146027,  -0.0002573684,  8.8250074e-05,  0.054095238,    0.0021872028,   2.3704102e-05,
    -0.00014724224, 0.00016213629,  -5.6329346e-05, 0.053434988,    1.0962194e-05,  -7.063249e-05,
    4.0346401e-05,  -9.2388976e-06, 9.7875446e-06,  -2.4176536e-05, 2.2977295e-05,  -7.4122914e-06,
    6.5382426e-05,  -6.4718019e-05, 2.1448745e-05,  6.6233123e-05,  -2.248355e-05,  7.7817596e-06};

TEST(LensAdjustment, AgreesWithScipyOnParametersAndCovariance) {
  std::vector<PosedView> views = problem();
  // From a start of its own: another focal length and centre, no distortion, poses that are off.
  Lens lens{{820, 780}, {280, 280}, {409.5, 389.5}, {0, 0, 0, 0}, kPi / 2};
  for (PosedView& view : views) {
    view.pose.rotation += Vec3d(0.02, -0.03, 0.01);
    view.pose.translation_mm += Vec3d(4, -3, 8);
  }
  AdjustmentOptions options;
  options.iterations = 200;
  options.tolerance = 1e-14;
  const double squared = adjust(lens, views, options);
  const double sigma[8] = {std::sqrt(kCovariance[0]),  std::sqrt(kCovariance[8]),  std::sqrt(kCovariance[15]),
                           std::sqrt(kCovariance[21]), std::sqrt(kCovariance[26]), std::sqrt(kCovariance[30]),
                           std::sqrt(kCovariance[33]), std::sqrt(kCovariance[35])};
  const double found[8] = {lens.focal.x(), lens.focal.y(), lens.center.x(), lens.center.y(),
                           lens.k[0],      lens.k[1],      lens.k[2],       lens.k[3]};
  // Two solvers stop at the same minimum to a thousandth of a standard deviation: both tolerances are far below.
  for (int i = 0; i < 8; ++i) EXPECT_NEAR(found[i], kParameters[i], 1e-3 * sigma[i]) << i;
  const double unknowns = 8 + 6 * kViews, coordinates = 2.0 * kViews * kColumns * kRows;
  const double noise = std::sqrt(squared / (coordinates - unknowns));
  EXPECT_NEAR(noise / kNoisePx, 1, 1e-7);
  const auto covariance = lens_covariance(lens, views, options.freedom, noise);
  ASSERT_TRUE(covariance);
  // SciPy's Jacobian is a central difference, good to some 1e-8, and the inverse has a condition of 1e4 once scaled.
  int next = 0;
  for (Eigen::Index r = 0; r < 8; ++r)
    for (Eigen::Index c = r; c < 8; ++c, ++next)
      EXPECT_NEAR((*covariance)(r, c), kCovariance[next], 1e-4 * sigma[r] * sigma[c]) << r << " " << c;
}

}  // namespace
}  // namespace lightwell::calibration
