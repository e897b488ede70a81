// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "lighting/field/light_field.h"
#include "lighting/fit/nonnegative_least_squares.h"

// What find_main_lights() and MainLightTracks are made of.
namespace lightwell {

// Luminance of the harmonics at points of the field within the box, of all points where none is inside: [harmonic][point].
// Of more than `most`, so many are taken from all over it.
Eigen::MatrixXd points_in_box(const LightField& field, const Vec3d& low, const Vec3d& high, std::size_t most);

// Of the points of points_in_box(): the light that they have together, Σ ∫ L, to which illuminances are compared.
double total_of(const Eigen::MatrixXd& points);

// An ambient term of radiance 1 and lights of illuminance 1 as harmonics, and the non-negative least squares by them.
class MainLightBasis {
 public:
  // weights: one a light, above 0 to 1. A light of weight 1 is free; one of less is held back by a penalty on its square, so that
  // alone it would have that part of its illuminance: as it goes to 0 the light fades, and others take what it leaves.
  // Empty: all 1.
  MainLightBasis(std::span<const Vec3d> directions, int degree, std::span<const double> weights = {});
  // points: [harmonic][point]. Returns [ambient, lights…][point], at least 0.
  [[nodiscard]] Eigen::MatrixXd powers(const Eigen::MatrixXd& points) const;
  // What they leave of the points.
  [[nodiscard]] Eigen::MatrixXd residual(const Eigen::MatrixXd& points) const;

 private:
  Eigen::MatrixXd columns_;
  SmallMatrix gram_;
};

// How much of the residual a light there would explain: squares over the points of the positive radiance in that direction.
double explained_by(const Eigen::MatrixXd& residual, const Vec3d& direction, int degree);
// Of a light there that alone explains the residual: its illuminance summed over the points.
double illuminance_from(const Eigen::MatrixXd& residual, const Vec3d& direction, int degree);
// Uphill to where a light explains most, by steps around the direction, from first_step_rad to a tenth of a degree.
Vec3d refined(const Eigen::MatrixXd& residual, Vec3d direction, int degree, double first_step_rad);
// Where on the whole sphere a light explains most.
Vec3d brightest(const Eigen::MatrixXd& residual, int degree);

// Illuminances of the lights at every point of the field: MainLights::illuminance.
std::vector<float> illuminances(const LightField& field, const MainLightBasis& basis, std::size_t lights);

}  // namespace lightwell
