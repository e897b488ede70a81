// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "lighting/field/field_grid.h"
#include "lighting/field/shear_plane.h"

namespace lightwell {

// Interpolation between few places by universal kriging: the linear combination of what was measured that has the least
// mean square error for light whose mean square difference between two places grows as their distance to the power 1.5,
// on a plane of unknown height and little known slope. At the places their values, smooth between them, and defined however
// they lie: one place gives its value everywhere, places on a line or in a plane say nothing across it.
// source: Matheron 1973, "The intrinsic random functions and their applications"
class Kriging {
 public:
  // places: [dimensions][count], metres; at least one. A place a tenth of the usual distance or more from all others has its
  // value within .5 %; those closer than about a hundredth share an error. Usual is the first quartile of all distances, if
  // that is above 1e-4 of the places' spread.
  explicit Kriging(const Eigen::MatrixXd& places);

  // What each place counts at `at`: [count], sum 1.
  [[nodiscard]] Eigen::VectorXd weights(const Eigen::VectorXd& at) const;
  // The precision of the values: valuesᵀ · precision · values is how unlikely they are, 0 for equal ones. [count][count]
  [[nodiscard]] const Eigen::MatrixXd& precision() const { return precision_; }
  // What to take for the values where each counts only in part. weights: [count], 0 to 1, of values as measured; one that
  // counts as much as any stays, one that counts 0 becomes what the others foretell for its place. Where all are 0 all stay.
  [[nodiscard]] Eigen::MatrixXd completion(const Eigen::VectorXd& weights) const;

 private:
  [[nodiscard]] double covariance(double distance, double product) const;
  Eigen::VectorXd centre_;
  Eigen::MatrixXd places_;  // from the centre
  double spread_ = 1;
  Eigen::MatrixXd precision_;
  Eigen::VectorXd mean_;  // what each place counts toward the mean, sum 1
};

// One direction of a field: what each of few parallel rays counts at every pixel of the plane across it.
struct RayKriging {
  // positions: of the probes, world, metres. direction: unit, world.
  RayKriging(const FieldGrid& grid, const Vec3d& direction, std::span<const Vec3d> positions);

  ShearPlane plane;
  Kriging kriging;          // of the rays, metres across the direction
  Eigen::MatrixXf weights;  // [pixels][positions]
  Eigen::MatrixXf
      square_cells;  // [pixels][positions], distance of the rays in cells across the direction, squared
};

}  // namespace lightwell
