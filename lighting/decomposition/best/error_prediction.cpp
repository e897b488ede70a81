// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/best/error_prediction.h"

#include <algorithm>
#include <cmath>

namespace lightwell {
namespace {

constexpr double kErrorOfCost = 0.34;
constexpr double kOwnErrorOfCells = 0.17;

}  // namespace

void predict_errors(const Atoms& atoms, double cell_cost, std::span<const double> fold_costs,
                    std::span<float> predicted) noexcept {
  double ground = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(atoms.count); ++k)
    ground += static_cast<double>(atoms.luminance[k] * std::max(0.0f, atoms.y[k]));
  double left_out = kOwnErrorOfCells * cell_cost;
  for (std::size_t k = fold_costs.size(); k-- > 0;) {
    predicted[k] = ground > 0 ? static_cast<float>(kErrorOfCost * std::sqrt(left_out) / ground) : 0.0f;
    left_out += std::max(0.0, fold_costs[k]);
  }
}

}  // namespace lightwell
