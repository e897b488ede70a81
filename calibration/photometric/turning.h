// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "calibration/photometric/mean_frame.h"
#include "lighting/lens.h"
#include "lighting/response.h"

namespace lightwell::calibration {

// A take of a still scene under constant light, the camera turned to the right by an angle about the image's vertical:
// lying on its side on a tripod, so that the axis of turning is not the lens's own.
struct TurnedTake {
  MeanFrame mean;
  double angle_deg = 0;
};

struct TurningFit {
  std::array<double, 3> vignetting = {0, 0, 0};
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  int terms = 0;
  double scene_scatter =
      0;  // relative, robust: how well the takes agree on the scene once vignetting is taken out
  std::size_t cells = 0;  // of the scene, seen by two takes or more
};

// ln L = ln S(direction in the scene) + ln T(θ): the same piece of the scene is seen at another angle off axis in every
// take. The unknown scene, a value for each cell of two degrees or a few pixels, is eliminated by subtracting its mean over the
// takes (fixed effects); the vignetting's terms, up to three, are fitted to what is left, with Tukey's weights, for cells
// with an edge in them agree badly. Covariance: each cell counts as one (sandwich).
// black: the dark frames' mean, where there are some; its difference from the response's dark code is subtracted, and should
// be the pattern alone.
// bad_input: fewer than two takes; the takes do not agree on a scene; the angles do not tell vignetting from it (to 5 %
// at the edge).
Result<TurningFit> fit_turning(const std::vector<TurnedTake>& takes, const MeanFrame* black, const Lens& lens,
                               const Response& response);

}  // namespace lightwell::calibration
