// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lighting/field/lamp_association.h"
#include "lighting/field/lamp_location.h"
#include "lighting/field/lamp_tracks.h"

namespace lightwell {

// A lamp as all probes that see it say, near or far.
struct LocatedLamp {
  LampLocation location;       // from the probe `from`
  int from = 0;                // index of a probe
  std::vector<int> sightings;  // [probes], of this lamp; −1: none
  // Where the location is near:
  Rgbd intensity = Rgbd::Zero();       // candela, mean over the probes that see it
  std::vector<Rgbd> intensity_toward;  // [probes], candela; 0 where it is not seen
  std::vector<bool> known;  // [probes]: it looks there, so what it sees of the lamp, be it nothing, counts
  double radius_m = 0;      // of a sphere as wide as probes see it
  // Where it is not:
  Rgbd illuminance = Rgbd::Zero();  // lux facing it, mean over the probes that see it
  double angular_radius_rad = 0;    // as wide as they see it
  bool ambiguous = false;           // it crosses with others' sightings, but in more than one way
};

// Which sightings of several probes are one lamp, and where it stands: first what their crossing tells without a doubt
// (lighting/field/lamp_association.h), then what is seen under nearly the same direction and as bright by all, last what one
// probe alone sees. Brightest first among the near, among the far. Every sighting belongs to one lamp, to more where lamps
// stand in one line.
// sigma_rad: of a sighting's direction, each way.
std::vector<LocatedLamp> locate_lamps(std::span<const ProbeSightings> probes, double sigma_rad);

}  // namespace lightwell
