// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calibration/lens/correspondences.h"
#include "calibration/lens/lens_adjustment.h"
#include "lighting/lens.h"

namespace lightwell::calibration {

// What became of one view.
struct ViewResult {
  std::string name;
  bool used = false;
  std::string reason;  // why it was not used; empty where it was
  double rms_px = 0;   // √mean(du² + dv²) of the points that count; of all where it is not used
  std::vector<std::size_t> rejected;  // points left out, by index
  TargetPose pose;
  std::vector<Vec2d> residuals_px;     // projection less pixel of every point; empty where no pose was found
  std::optional<std::size_t> repeats;  // an earlier view of the same pose (repeated_views.h)
};

// Whether the target's points are exact, or a printed grid whose stretch, shear and bow are to be found as far as
// the views support it (supported_shape). All views then show one board; turned by 180 degrees it is the same.
enum class TargetTrust { exact, printed };

// The points would have the projection stop growing inside their field, or nearly: it is held at kLeastSlope there.
struct LensConstraint {
  double theta_rad = 0;  // where it grows least
  // How far that moves the lens from where the points alone would put it: the most of a parameter, in standard deviations
  // of what they say. The covariance has this shift in it, as if it were an error of one standard deviation.
  double shift_sigma = 0;
  Eigen::Matrix<double, 8, 1> shift = Eigen::Matrix<double, 8, 1>::Zero();  // in the covariance's order
};

struct LensCalibration {
  Lens lens;  // max_theta_rad: supported_theta_rad, until set_field says otherwise
  double supported_theta_rad =
      0;  // the largest angle of a point that counts; beyond it the lens is extrapolated
  LensFreedom freedom;
  Eigen::Matrix<double, 8, 8> covariance;  // fx, fy, cx, cy, k1 … k4; zero rows for what is held
  std::optional<LensConstraint> constraint;
  double rms_px = 0;  // √mean(du² + dv²) over the points that count
  // The same for views held out, in at most five parts, each once: a lens of this freedom fitted to the others, the
  // held view's pose alone to its own points. Which points count, the board's shape, the aspect and the number of
  // coefficients were chosen with all views, the held ones too: the choice among four numbers of coefficients is in it.
  // Infinite where too few are left to fit a lens to.
  double held_out_rms_px = 0;
  double noise_px = 0;            // standard deviation of a coordinate, degrees of freedom counted
  std::vector<ViewResult> views;  // in the order given
  TargetTrust trust = TargetTrust::exact;
  std::optional<TargetShape> shape;  // of the board, where it was asked for and the views support it
  // Of a board that was said to be exact and that the views say is not: lens and covariance then claim too much.
  std::optional<TargetShape> doubted_shape;
};

// Kannala–Brandt lens from views of a target, without an initial guess.
// Points further than 5 robust standard deviations off are left out, views with half of their points so far off
// too; both come back when the lens explains them. Coefficients and aspect: select_freedom.
// bad_input names the view or the reason: fewer than 3 usable views, all views parallel, all points in the middle,
// points that fit no lens, a board that is stretched or sheared by more than a printer does.
Result<LensCalibration> calibrate_lens(const TargetViews& target_views,
                                       TargetTrust trust = TargetTrust::exact);

// Ends the lens's field at an angle, nearer than the points reach or farther. bad_input, with the limit, where the
// projection stops growing before; the calibration is then as it was.
Status set_field(LensCalibration& calibration, double max_theta_rad);

// Pose alone, the lens held: what a test view says of a lens. used is false where no pose is found.
ViewResult fit_view(const Lens& lens, const TargetView& view);

}  // namespace lightwell::calibration
