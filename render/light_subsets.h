// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "render/light_rows.h"

namespace lightwell::render {

// Interleaved sampling (Keller and Heidrich 2001; Wald et al. 2002): of a square of side × side pixels each takes another
// subset of the lights, and the picture is what neighbours on the same surface give together (shaders/interleave.glsl). Only
// weak lights take part: where a light, with those close beside it, has a large share of the power, the filter would be seen
// to blur its shadow.
//
// Puts the strong lights first, in their order, then the weak ones along a curve through all directions, so that every
// side²-th of them, from any on, are spread over all that the weak come from. Returns how many are strong: all where side is
// 1, or where the weak are too few for the subsets.
// all: the picture's lights, of which rows may be a part
std::size_t arrange_subsets(std::span<LightRow> rows, std::span<const LightRow> all, int side);

}  // namespace lightwell::render
