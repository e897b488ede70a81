// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lighting/light_set.h"

namespace lightwell {

// The lights in progressive order with parents, so that the first n, the others folded into them (take_lights),
// are a good set for every n: from one group of all lights on, the group with the largest sum of luminance ×
// squared distance from its mean is divided in two, across its longest axis where that leaves the least of that
// sum; a group is shown by its strongest light. Lights in one place, and lights without power, come last.
// O(n log² n) for all but strange sets, where progressive_order (lighting/decomposition/split_tree.h) is O(n²).
std::vector<DirectionalLight> as_tree(const std::vector<DirectionalLight>& lights);

}  // namespace lightwell
