// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lighting/field/light_field.h"

namespace lightwell {

// A field stored only where a coarser one does not foretell it. The lattices of every 2ⁿ-th point (and the last) are gone
// through from the coarsest: a point that linear interpolation between the next coarser one, as it will be read, gives
// within the bound is left out. So every point is within the bound, however many levels it stands for.

// [points], 1 where stored. bound: of a point's error over all harmonics and colours, as a part of the RMS of the points'
// harmonics; 0: all are stored.
std::vector<std::uint8_t> stored_points(const LightField& field, double bound);

// Puts what was left out back in place: the harmonics of points that are not stored, from those that are.
void fill_left_out(LightField& field, const std::vector<std::uint8_t>& stored);

}  // namespace lightwell
