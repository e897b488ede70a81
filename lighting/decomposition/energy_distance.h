// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "lighting/decomposition/atoms.h"

// The energy distance between two distributions of light over the sphere, 2 E|a−b| − E|a−a'| − E|b−b'|
// (Székely and Rizzo 2013): it needs no bins, and sees every edge a shadow could have (it integrates the
// squared difference of the light in every half-space). Distances are softened, √(r² + (0.5°)²): what is
// nearer than a sun's width is one place.
namespace lightwell {

// Lights and what they weigh; weights ≥ 0 and sum to 1.
struct Placement {
  Directions direction;
  Eigen::VectorXd weight;
};

// Softened distances, rows: a, columns: b.
Eigen::MatrixXd softened_distances(const Directions& a, const Directions& b);

// argmin over w ≥ 0 of ½ wᵀ(3 − distances)w − wᵀ(3 − potential), scaled to sum 1: the weights at the lights
// that come nearest to a unit distribution whose mean distance from light i is potential[i]. The constant 3
// keeps the matrix positive definite and pins the sum. start: any weights, their positive ones are the first
// guess of the active set.
Eigen::VectorXd nearest_weights(const Eigen::MatrixXd& distances, const Eigen::VectorXd& potential,
                                const Eigen::VectorXd& start);

// Energy distance of the placement to the atoms' luminance, without the atoms' own constant term.
double energy(const Placement& placement, const Atoms& atoms);

// Moves lights down the energy distance by steps that grow while their direction holds and shrink when it
// turns (resilient descent), weights being found anew every tenth step. theta_max_rad: lights stay inside
// this cap.
Placement descend(Placement placement, const Atoms& atoms, double theta_max_rad, int steps);

}  // namespace lightwell
