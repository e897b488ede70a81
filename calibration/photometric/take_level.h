// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calibration/photometric/mean_frame.h"
#include "lighting/lens.h"
#include "lighting/response.h"
#include "lighting/result.h"

// Whether a take is what it is said to be, by the median code in the lens's field, of each colour.
namespace lightwell::calibration {

// Codes above the response's code of darkness, as a part of those up to clip_code, that a dark take may lie: as much as a
// response errs in its toe that was not measured in darkness. An even scene must lie higher.
inline constexpr double kDarkPart = 0.06;

// Pixels that the border of the field does not cut: farther inside it than a pixel and a half, three in a mosaic.
// bad_input: fewer than a hundred; the error names max_theta_deg.
Status check_field(const Lens& lens, bool mosaic);

// bad_input: brighter than dark frames may be.
Status check_is_dark(const MeanFrame& mean, const Lens& lens, const Response& response,
                     const std::string& name);
// bad_input: no brighter than dark frames may be, or so dark that one code is more than a twentieth of the light.
Status check_is_lit(const MeanFrame& mean, const Lens& lens, const Response& response,
                    const std::string& name);

}  // namespace lightwell::calibration
