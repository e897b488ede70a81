// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lighting/light_set.h"
#include "lighting/polar_map.h"

namespace lightwell {

// Each light's (lighting/second_moment.h), from the bins that are nearest to it. map: radiance finite and ≥ 0
void set_angular_radii(const PolarMap& map, std::span<DirectionalLight> lights);

}  // namespace lightwell
