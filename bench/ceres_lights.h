// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lighting/fit/lambertian_probe.h"
#include "lighting/fit/variable_projection.h"

namespace lightwell::bench {

// The fit of few lights as a general solver does it: Ceres, all 3 + 5 M unknowns at once, powers bounded below by 0,
// directions on their sphere, derivatives by hand, from the trial's directions and powers of an even share.
// Returns the relative RMSE of the probe.
double ceres_fit(const ProbeIrradiance& observed, const LightsTrial& start);

}  // namespace lightwell::bench
