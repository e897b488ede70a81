// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lighting/vector.h"

namespace lightwell {

// Independent points of the unit square, coordinates in [0, 1): SplitMix64 (Steele, Lea and Flood 2014) from the
// seed on. The same on every machine; the first n do not depend on count.
std::vector<Vec2d> random_points(std::size_t count, std::uint32_t seed);

}  // namespace lightwell
