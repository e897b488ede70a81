// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "calibration/photometric/curve_trial.h"
#include "calibration/photometric/patches.h"
#include "calibration/photometric/response_fit.h"
#include "lighting/result.h"

// What is known of a fitted response's error: see ResponseFit.
namespace lightwell::calibration {

// Fills in the covariance, noise scale, degrees of freedom and Student's t. several_exposures: the patches are readings
// of the same ones, which agree better than their luminance is known.
// bad_input: the patches do not tell the parameters apart
Status set_covariance(ResponseFit& fit, const Trial& trial, bool several_exposures);

// code_sigma: of patches that do not say
PatchResidual residual_of(const ResponseFit& fit, const Patch& patch, double code_sigma);

// The longest run of codes between the fitted patches where the error is small enough; none: there is no such code.
std::optional<std::array<double, 2>> usable_codes(const ResponseFit& fit);

}  // namespace lightwell::calibration
