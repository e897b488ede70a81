// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lighting/field/lamp_location.h"
#include "lighting/field/lamp_tracks.h"

namespace lightwell {

// Sightings of several probes that cross in one place.
struct CrossingLamp {
  std::vector<int> sightings;  // [probes], −1: none
  LampLocation location;       // near; from the first probe that sees it
  bool ambiguous = false;      // other lamps explain what is seen as well
};

// The fewest lamps near the probes that explain the most of what they see: a place counts by the sightings whose direction it
// explains within their errors and whose light follows the inverse square up to a factor of 2 (4 where three probes or more agree: lamps are no
// points), and not where a probe that looks there sees nothing and only two others do. Two lamps may share a sighting, where they stand in one line, but
// each explains two of its own. Where lamps stand in rows, two probes' rays often cross in several ways that explain all as
// well: such lamps are ambiguous, and only another probe can tell.
// sigma_rad: of a sighting's direction, each way. Of more than 128 places that rays may cross in, the best supported.
std::vector<CrossingLamp> crossing_lamps(std::span<const ProbeSightings> probes, double sigma_rad);

}  // namespace lightwell
