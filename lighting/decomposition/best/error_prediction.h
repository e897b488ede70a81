// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lighting/decomposition/atoms.h"

namespace lightwell {

// Shadow error (LightError::shadow_rel_rmse) that the first n lights will show, for every n, without looking: what lights
// show wrongly grows with how far atoms are from the light that stands for them (PlaceSearch::cell_cost) and with what
// folding leaves out (PersistentTree::costs); on the ground it is relative to the light that falls there.
// Fitted on 29 captured maps, 1 to 128 lights: the ratio to the measured error has a spread (one sigma) of a quarter,
// 95 % lie within a factor of 1.6.
// fold_costs, predicted: a light
void predict_errors(const Atoms& atoms, double cell_cost, std::span<const double> fold_costs,
                    std::span<float> predicted) noexcept;

}  // namespace lightwell
