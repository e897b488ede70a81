// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "calibration/photometric/mean_frame.h"
#include "lighting/flat_field.h"
#include "lighting/lens.h"
#include "lighting/response.h"

namespace lightwell::calibration {

struct FlatFit {
  FlatField flat;
  int vignetting_terms = 0;                              // of 3; the fewest that the frames support
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of flat.vignetting
  std::array<double, 3> level_cd_m2 = {0, 0, 0};         // of the uniform scene on the axis, a colour each
  double offset_rms_codes = 0;                           // of the fixed pattern
  double offset_sigma_codes = 0;                         // its standard error: temporal noise over √frames
  double tilt = 0;         // of the scene: relative change from the centre to the edge
  std::size_t pixels = 0;  // that were fitted
  bool from_dark = false;  // the pattern was taken from dark frames
};

// Vignetting and fixed pattern from frames of an even scene: code = response(level · T(θ)) + offset, T an even polynomial
// of the angle off axis with up to three terms (each more only where it lowers the residual by more than noise does).
// Tukey's weights keep lamps, dust and dead pixels out. The offset is what remains of each pixel; with dark frames it is
// what they say, and the even scene tells the vignetting alone. Pixels that the border of the field cuts, or beyond, get
// an offset from dark frames only.
// bad_input: sizes or bits that do not fit lens and response, fewer than 2 frames, clipped or dark pixels, a scene that is
// not even (changes by more than a fifth from the centre to the edge).
Result<FlatFit> fit_flat_field(const MeanFrame& even, const std::optional<MeanFrame>& dark, const Lens& lens,
                               const Response& response, const std::string& name_for_errors);

nlohmann::ordered_json report_to_json(const FlatFit& fit, const MeanFrame& even);
// The text of flat.json: the flat field, and the report as "fit".
std::string flat_file(const FlatFit& fit, const MeanFrame& even);

}  // namespace lightwell::calibration
