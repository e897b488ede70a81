// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "lighting/field/near_lamp.h"
#include "lighting/luminaire/luminaire.h"

namespace lightwell {

// A lamp that probes have found, as one to render with.
struct LocatedLuminaire {
  Luminaire lamp;
  Eigen::Matrix3d world_from_lamp;  // rotation; the lamp stands at the place that the probes found
  int behind = 0;                   // probes that it is turned away from: what they see of it is not in it
};

// Aimed at the middle of the probes that see it, it is a disc as wide as they see it, of point sources that send
// intensity_toward() each their part: near objects it makes soft shadows. emissions: in the world, at least one;
// radius_m: 0 makes a point.
LocatedLuminaire located_luminaire(std::span<const LampEmission> emissions, double radius_m);

}  // namespace lightwell
