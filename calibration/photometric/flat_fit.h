// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibration/photometric/mean_frame.h"
#include "lighting/flat_field.h"
#include "lighting/lens.h"
#include "lighting/response.h"

namespace lightwell::calibration {

// The mean of a take and its name, for errors and the report.
struct FlatTake {
  std::string name;
  MeanFrame mean;
  std::array<double, 3> level_cd_m2 = {0, 0, 0};  // found: of the even scene on the axis, a colour each
  std::size_t masked_pixels = 0;                  // found: left out as lamps or dust
};

struct FlatFit {
  FlatField flat;
  std::vector<FlatTake> takes;  // without their codes
  std::optional<double> dark_temperature_c;
  // The dark frames' mean code in the field less the response's code of darkness, of each colour (grey: the first). Not
  // part of the offsets: it is an error of the response's toe, or darkness that was not dark.
  std::array<double, 3> dark_level_error_codes = {0, 0, 0};
  int vignetting_terms = 0;                              // of 3; the fewest that the frames support
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of flat.vignetting
  double offset_rms_codes = 0;                           // of the fixed pattern
  double offset_sigma_codes = 0;  // its standard error, pixel by pixel: temporal noise over √frames
  double offset_shared_sigma_codes =
      0;                  // and what all pixels share, through level, tilt and vignetting; rms over the field
  double gain_rms = 0;    // of the pixels' gains about 1
  double gain_sigma = 0;  // of that, noise; infinite: the takes cannot tell gain from offset
  double tilt = 0;        // of the scene: relative change from the centre to the edge
  double scene_scatter = 0;        // turning: disagreement of the takes on the scene, relative
  std::vector<double> turned_deg;  // turning: of each take; empty: the takes are of even scenes
  std::size_t pixels = 0;          // readings that were fitted; turning: places of the scene
  bool from_dark = false;          // the offsets were taken from dark frames
  std::size_t masked_pixels = 0;   // left out of one take or more as lamps or dust
};

// Vignetting and fixed pattern from takes of even scenes, of one brightness or several:
// code = response(gain · level · T(θ)) + offset. Vignetting: fit_vignetting, from all takes together; each may have a tilt
// of its own. Lamps and dust are masked (fit_without_lamps_and_dust): where no other take and no dark frames tell a masked
// pixel's offset, it is its column's. Offset and gain of each pixel: fit_pattern, from what remains of it; without dark frames and with one take
// there is an offset only. With dark frames the offsets come from them (and are good beyond the field too), unless the
// gains are supported too; the dark frames' level is taken out (dark_level_error_codes), what is left is the pattern.
// Pixels that the border of the field cuts, or beyond, get an offset from dark frames only. bad_input: dark frames with a
// response that has no code for darkness (log with c = 0), sizes or bits that do not fit lens and response, fewer than 2
// frames, clipped or dark pixels, dark frames that are not dark or an even scene that is (take_level.h), over a
// twentieth of the field masked, a scene that is
// not even (changes by more than a fifth from the centre to the edge).
Result<FlatFit> fit_flat_field(const std::vector<FlatTake>& even, const std::optional<MeanFrame>& dark,
                               const Lens& lens, const Response& response);

// Vignetting from turning the camera under constant light (fit_turning); offsets from dark frames alone.
Result<FlatFit> fit_turned_flat_field(const std::vector<FlatTake>& takes,
                                      const std::vector<double>& turned_deg,
                                      const std::optional<MeanFrame>& dark, const Lens& lens,
                                      const Response& response);

nlohmann::ordered_json report_to_json(const FlatFit& fit);
// The text of flat.json: the flat field, and the report as "fit".
std::string flat_file(const FlatFit& fit);

}  // namespace lightwell::calibration
