// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace lightwell::render {

// Sides of lights' shadow maps, of a common budget of texels. A map blurs a light's shadow by a texel, so the error that
// maps add is Σ power / side: the next doubling goes where it saves most of that for its texels.
// powers: ≥ 0, a light; smallest, largest: sides, their ratio a power of two; texels: all maps together, unless even the
// smallest need more. Returned: smallest · 2ᵏ a light
std::vector<int> share_texels(std::span<const double> powers, int smallest, int largest, double texels);

}  // namespace lightwell::render
