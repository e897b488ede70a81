// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calibration/lens/correspondences.h"
#include "calibration/lens/target_pose.h"
#include "lighting/lens.h"

// Lens calibration by others, on the corners that ours gets.
namespace lightwell::bench {

// A lens of whatever model, with where it sees the targets.
struct SolvedLens {
  std::string refused;  // what the solver said instead of a lens; empty: the rest is there
  std::function<Vec2d(const Vec3d&)> project;  // camera frame to pixel
  std::vector<calibration::TargetPose> poses;  // one a view
  // Where a point of the nominal target is on the real one; empty: there.
  std::function<Vec3d(const Vec3d&)> place;
};

// cv::fisheye::calibrate with what it offers: no guess, skew fixed. recompute_extrinsics: its flag of that name, off by
// default (opencv #23962).
SolvedLens solve_opencv(const calibration::TargetViews& views, bool recompute_extrinsics);

// A start for mrcal's C library, which needs one (its seeding is in Python): our own result, poses and all.
struct MrcalStart {
  Lens lens;
  std::vector<calibration::TargetPose> poses;
};
// mrcal_optimize with its outlier rejection and regularisation, as mrcal-calibrate-cameras runs it.
// model: "LENSMODEL_OPENCV8", "LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=16_Ny=16_fov_x_deg=200".
// bend_board: mrcal's two parameters of a board that is not flat. Targets: grids of equal pitch.
SolvedLens solve_mrcal(const calibration::TargetViews& views, const MrcalStart& start,
                       const std::string& model, bool bend_board);

}  // namespace lightwell::bench
