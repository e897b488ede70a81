// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lighting/field/lamp_tracks.h"
#include "lighting/field/light_field.h"

namespace lightwell {

// What a lamp sends toward a probe that looks at it.
struct LampEmission {
  Vec3d direction;  // unit, from the lamp to the probe
  double weight;    // what the probe counts, above 0
  Rgbd intensity;   // candela
};

// Toward a direction from the lamp (unit): between those toward the probes, weighted by the inverse fourth power of the
// angle, so that what a probe sees goes on along its ray. emissions: at least one. Candela.
Rgbd intensity_toward(std::span<const LampEmission> emissions, const Vec3d& direction);

// Adds the light of a lamp whose place is known to a field: an even disc of the lamp's radius that faces every point, of
// the illuminance intensity / distance². Its intensity is intensity_toward(), so that beams, shades and what
// stands before a lamp are as the probes saw them. Nearer than the lamp's radius, or half a cell, which a
// grid cannot show, the illuminance grows no more.
// probes: positions, metres; weights: what each counts, 0 to 1. Degree of the field: up to kMostFieldDegree.
void add_near_lamp(const LampTrack& lamp, std::span<const Vec3d> probes, std::span<const double> weights,
                   LightField& field);

}  // namespace lightwell
