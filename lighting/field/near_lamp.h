// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lighting/field/lamp_tracks.h"
#include "lighting/field/light_field.h"

namespace lightwell {

// Adds the light of a lamp whose place is known to a field: an even disc of the lamp's radius that faces every point, of
// the illuminance intensity / distance². The intensity toward a point lies between those toward the probes, weighted by
// the inverse fourth power of the angle as the lamp sees it: what a probe sees goes on along its ray, so that beams,
// shades and what stands before a lamp are as the probes saw them. Nearer than the lamp's radius, or half a cell, which a
// grid cannot show, the illuminance grows no more.
// probes: positions, metres; weights: what each counts, 0 to 1. Degree of the field: up to kMostFieldDegree.
void add_near_lamp(const LampTrack& lamp, std::span<const Vec3d> probes, std::span<const double> weights,
                   LightField& field);

}  // namespace lightwell
