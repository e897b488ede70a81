// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <set>
#include <string>
#include <utility>

#include "calibration/lens/correspondences.h"
#include "lighting/lens.h"

namespace lightwell::test {

struct BoardSetup {
  int views = 30;
  int columns = 10, rows = 10;
  double pitch_mm = 30;
  double distance_mm = 300;    // nearest; the farthest is twice that
  double field_rad = kPi / 2;  // boards' centres lie up to here, less half a board; no point lies beyond
  double tilt_rad = 0.7;       // largest angle between a board's normal and the line of sight
  double noise_px = 0.1;
  double outliers = 0;  // this part of the points is somewhere within 30 px
  unsigned seed = 1;
};

struct SyntheticViews {
  calibration::TargetViews target_views;
  std::set<std::pair<std::size_t, std::size_t>> wrong;  // (view, point) of the outliers
};

// Boards all over the field of a lens, at random tilts and turns.
inline SyntheticViews board_views(const Lens& lens, const BoardSetup& setup) {
  std::mt19937 random(setup.seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> noise(0, setup.noise_px);
  SyntheticViews out;
  out.target_views.image_size = lens.image_size;
  for (int v = 0; v < setup.views; ++v) {
    const double distance = setup.distance_mm * (1 + unit(random));
    const double theta = setup.field_rad * std::sqrt(unit(random));
    const double phi = 2 * kPi * unit(random);
    const Vec3d sight(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
    const double tilt = setup.tilt_rad * std::sqrt(unit(random));
    const double tilt_phi = 2 * kPi * unit(random);
    const Eigen::Matrix3d facing =
        Eigen::Quaterniond::FromTwoVectors(Vec3d::UnitZ(), sight).toRotationMatrix();
    const Vec3d axis(std::cos(tilt_phi), std::sin(tilt_phi), 0);
    const Eigen::Matrix3d rotation = facing * Eigen::AngleAxisd(tilt, axis).toRotationMatrix() *
                                     Eigen::AngleAxisd(2 * kPi * unit(random), Vec3d::UnitZ());
    const Vec3d half(setup.pitch_mm * (setup.columns - 1) / 2, setup.pitch_mm * (setup.rows - 1) / 2, 0);
    calibration::TargetView view{"view " + std::to_string(v), {}};
    for (int r = 0; r < setup.rows; ++r)
      for (int c = 0; c < setup.columns; ++c) {
        const Vec3d target(setup.pitch_mm * c, setup.pitch_mm * r, 0);
        const Vec3d p = rotation * (target - half) + distance * sight;
        const double n1 = noise(random), n2 = noise(random);
        const bool wrong = unit(random) < setup.outliers;
        const Vec2d off(60 * unit(random) - 30, 60 * unit(random) - 30);
        if (std::atan2(p.head<2>().norm(), p.z()) > setup.field_rad) continue;
        if (wrong) out.wrong.insert({static_cast<std::size_t>(v), view.points.size()});
        view.points.push_back({target, lens.project(p) + Vec2d(n1, n2) + (wrong ? off : Vec2d(0, 0))});
      }
    out.target_views.views.push_back(std::move(view));
  }
  return out;
}

}  // namespace lightwell::test
