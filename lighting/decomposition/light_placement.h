// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lighting/decomposition/atoms.h"

namespace lightwell {

// How long to look for places from nothing.
enum class Effort {
  frame,     // a live daemon's first frame; the next ones improve it
  thorough,  // a set that is made once
};

// Directions of `count` lights of least cost (error_kernel.h) for the atoms: starts by weighted k-means, some drawn to
// what is bright, resilient descent of each on merged atoms, then of the best on all. Deterministic.
// atoms: more than count, which is 1 at least; lights stay inside the cap of theta_max_rad
std::vector<Vec3d> place_lights(const Atoms& atoms, int count, double theta_max_rad, Effort effort);

// Lights that stand somewhere, further down to the nearest places of least cost.
std::vector<Vec3d> descend_lights(const Atoms& atoms, std::vector<Vec3d> lights, double theta_max_rad,
                                  int steps);

}  // namespace lightwell
