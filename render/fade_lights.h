// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lighting/light_set.h"

namespace lightwell::render {

// take_lights for a fraction of a light: between the sets of the whole numbers around it, without a jump from one to the
// next. The last light has that share of its power, the rest is where it would be without it. count: ≥ 1
LightSet fade_lights(const LightSet& set, double count);

}  // namespace lightwell::render
