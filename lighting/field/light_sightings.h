// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lighting/field/lamp_sightings.h"
#include "lighting/light_set.h"

namespace lightwell {

// A lamp in a set of directional lights: those that stand for it, and what they are together.
struct LightSighting {
  LampSighting lamp;                // without harmonics and shares
  std::vector<std::size_t> lights;  // of the set
};

// Where a set's lights stand so close and strong that they are one small lamp: about the brightest light that is left, the
// smallest circle beyond which the set is a sixth as bright a steradian, with a fiftieth of the set's light, as LampFinder asks of maps.
// Brightest first, at most LampFinder::kMostLamps.
std::vector<LightSighting> light_sightings(const LightSet& set);

}  // namespace lightwell
