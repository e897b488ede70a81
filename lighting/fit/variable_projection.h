// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>

#include "lighting/fit/fit_observations.h"
#include "lighting/fit/nonnegative_least_squares.h"
#include "lighting/vector.h"

namespace lightwell {

inline constexpr int kMostFittedLights = kMostUnknowns - 1;

// Directional lights and an ambient term as a trial of the fit.
struct LightsTrial {
  int count = 0;
  Eigen::Matrix<double, 3, kMostFittedLights> direction =
      Eigen::Matrix<double, 3, kMostFittedLights>::Zero();  // unit, the first `count` columns
  // Row 0: ambient radiance; row k + 1: illuminance of light k. Relative to the observations' scale.
  Eigen::Array<double, kMostFittedLights + 1, 3> power =
      Eigen::Array<double, kMostFittedLights + 1, 3>::Zero();
  std::array<unsigned, 3> positive{};  // bit j of channel c: power(j, c) is not held at 0
  double cost = 0;                     // sum of the squared residuals

  void add(const Vec3d& unit) { direction.col(count++) = unit; }
  void remove(int light) {
    for (int k = light; k + 1 < count; ++k) direction.col(k) = direction.col(k + 1);
    --count;
  }
};

// Least squares in directions and powers, of which the powers are solved for: min over directions of the least cost over
// powers ≥ 0. Two angles a light remain, in the plane that touches the sphere at its direction; Levenberg–Marquardt on
// them with the analytic Jacobian of the projected residual, less the term that Kaufman shows to be small.
// Everything comes from inner products of columns: no matrix with a row an observation is ever factored.
// source: Golub, Pereyra 2003, "Separable nonlinear least squares"; Kaufman 1975, "A variable projection method …"
class VariableProjection {
 public:
  // observations outlive it. Allocates here and nowhere else.
  explicit VariableProjection(const FitObservations& observations);

  // The best powers of the trial's directions, and their cost.
  void solve_powers(LightsTrial& trial) noexcept;

  struct Limits {
    int iterations = 20;
    double enough = 1e-7;  // relative decrease of the cost below which it is at its end
  };
  // Moves the directions downhill; the cost never grows. trial: with powers. Returns the iterations it took.
  int refine(LightsTrial& trial, const Limits& limits) noexcept;

  // What the observations say against moving a light: JᵀJ of the projected residual in the two angles of every light,
  // (t0, u0, t1, …), with the tangents of tangents_of.
  using Normal = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 2 * kMostFittedLights,
                               2 * kMostFittedLights>;
  using Gradient = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 2 * kMostFittedLights, 1>;
  void derivatives(const LightsTrial& trial, Normal& normal, Gradient& gradient) noexcept;

  // Residual (observation − model), [rows][3], of a trial with powers.
  void residual(const LightsTrial& trial, Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, 3>> out) noexcept;

  [[nodiscard]] const SmallMatrix& gram() const { return gram_; }  // of the columns of the last solve_powers

 private:
  void fill_values(const LightsTrial& trial) noexcept;

  const FitObservations& observations_;
  Eigen::MatrixXd values_;  // [rows][1 + lights]: ambient, then every light's column
  Eigen::MatrixXd slopes_;  // [rows][2 × lights]: derivatives along the tangents
  SmallMatrix gram_;
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::ColMajor, kMostUnknowns, 3> right_;
};

// Two unit vectors across a direction and each other.
struct Tangents {
  Vec3d t, u;
};
Tangents tangents_of(const Vec3d& direction);

// The direction after a step along its tangents, radians.
Vec3d moved(const Vec3d& direction, double along_t, double along_u);

}  // namespace lightwell
