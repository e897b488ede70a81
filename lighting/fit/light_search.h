// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "lighting/fit/fit_observations.h"
#include "lighting/fit/variable_projection.h"

namespace lightwell {

// Where the lights are: the fit has many local optima, and a descent ends in the one that it starts above. Two ways
// lead to good ones: pursuit, which gives the residual its best further light, and exchange, which takes a light away
// and lets pursuit find it anew. Random starts find what these miss. Allocates nothing after it is made.
class LightSearch {
 public:
  // observations outlive it. Descents end where an iteration wins less than the part `enough` of the cost.
  LightSearch(const FitObservations& observations, double enough);

  // To be called where the columns of the observations have changed, as with another weight of the ground.
  void columns_changed() noexcept;

  // The trial with one light more, in the best of 162 directions spread over the sphere, refined.
  // trial: with powers, fewer than kMostFittedLights
  [[nodiscard]] LightsTrial with_one_more(const LightsTrial& trial) noexcept;
  // The trial with a light less, refined.
  [[nodiscard]] LightsTrial without(const LightsTrial& trial, int light) noexcept;
  // One light leaves and is found anew; kept, in its place, where that lowers the cost by more than the part `gain`.
  bool exchange_one(LightsTrial& trial, int light, double gain) noexcept;
  // Every light in turn, until a whole round has won nothing or `rounds` are over.
  void exchange(LightsTrial& trial, int rounds, double gain) noexcept;
  void refine(LightsTrial& trial, int iterations) noexcept { solver_.refine(trial, {iterations, enough_}); }
  void solve_powers(LightsTrial& trial) noexcept { solver_.solve_powers(trial); }
  void residual(const LightsTrial& trial, Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, 3>> out) noexcept {
    solver_.residual(trial, out);
  }

 private:
  [[nodiscard]] Vec3d best_addition(const LightsTrial& trial) noexcept;

  const FitObservations& observations_;
  double enough_;
  VariableProjection solver_;
  Eigen::Matrix<double, 3, Eigen::Dynamic> directions_;
  Eigen::MatrixXd columns_;  // [rows][directions]
  Eigen::Matrix<double, Eigen::Dynamic, 3> residual_;
  Eigen::MatrixXd values_;  // [rows][1 + lights]
};

// Lights in random directions, without powers. state: makes the next ones.
LightsTrial random_directions(int count, std::uint64_t& state) noexcept;

}  // namespace lightwell
