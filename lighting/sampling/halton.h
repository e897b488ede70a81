// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lighting/vector.h"

namespace lightwell {

// Radical inverse of i: its digits in the base mirrored at the point. In [0, 1). base ≥ 2.
double radical_inverse(std::uint64_t i, unsigned base);

// The first count points of the Halton sequence in bases 2 and 3, index 1 first: (½, ⅓), (¼, ⅔), …
// Progressive: every prefix is well spread, and the points do not depend on count.
// seed ≠ 0 shifts the whole sequence on the unit torus (Cranley and Patterson 1976). Coordinates in [0, 1).
std::vector<Vec2d> halton_points(std::size_t count, std::uint32_t seed = 0);

}  // namespace lightwell
