// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lighting/light_set.h"

namespace lightwell {

// Puts lights into progressive order with parents, so that the first n, the others folded into them
// (take_lights), are a good set for every n: lights are merged two by two where w_a w_b |d_a − d_b| is least
// (what the energy distance loses by it), and each undone merge, the last first, adds its weaker side as a
// light whose parent is the stronger. O(n²) memory-free; n up to a few thousand.
std::vector<DirectionalLight> progressive_order(const std::vector<DirectionalLight>& lights);

}  // namespace lightwell
