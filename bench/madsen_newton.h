// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cmath>

#include "lighting/fit/lambertian_probe.h"

namespace lightwell::bench {

// Few lights as printed: 3 + 5 M unknowns, ambient RGB, then two angles and RGB a light; Newton's iterations on the
// equations of all faces (a step solves the linearised system by least squares); all radiances begin at 1, the lights
// evenly spread. Nothing keeps a radiance from falling below 0. Slow and plain: a peer and the subject of tests.
// source: Madsen, Sørensen, Vittrup 2003, section 3.2, eqs. 4–9
struct MadsenFit {
  Rgbd ambient = Rgbd::Ones();
  Eigen::Matrix<double, 3, Eigen::Dynamic> direction;
  Eigen::Array<double, Eigen::Dynamic, 3> power;
  double residual = 0;  // relative RMSE of the probe
  [[nodiscard]] bool negative() const { return (ambient < 0).any() || (power < 0).any(); }
};

inline MadsenFit madsen_newton(const ProbeIrradiance& observed, int lights, int iterations = 20) {
  const ProbeNormals normals = probe_normals();
  Eigen::VectorXd unknown = Eigen::VectorXd::Ones(3 + 5 * lights);
  for (int k = 0; k < lights; ++k) {  // θ from +Y, λ, then RGB
    unknown[3 + 5 * k] = std::acos(1 - (2 * k + 1.0) / lights);
    unknown[4 + 5 * k] = k * kPi * (3 - std::sqrt(5.0));
  }
  Eigen::VectorXd difference(3 * kProbeNormals);
  Eigen::MatrixXd jacobian(3 * kProbeNormals, unknown.size());
  const auto evaluate = [&] {
    jacobian.setZero();
    for (int i = 0; i < kProbeNormals; ++i)
      for (int c = 0; c < 3; ++c) {
        const int row = 3 * i + c;
        double model = kPi * unknown[c];
        jacobian(row, c) = kPi;
        for (int k = 0; k < lights; ++k) {
          const int at = 3 + 5 * k;
          const double st = std::sin(unknown[at]), ct = std::cos(unknown[at]);
          const double sl = std::sin(unknown[at + 1]), cl = std::cos(unknown[at + 1]);
          const Vec3d n = normals.col(i);
          const double cosine = n.dot(Vec3d(st * sl, ct, st * cl));
          if (cosine <= 0) continue;
          const double power = unknown[at + 2 + c];
          model += power * cosine;
          jacobian(row, at) = power * n.dot(Vec3d(ct * sl, -st, ct * cl));
          jacobian(row, at + 1) = power * n.dot(Vec3d(st * cl, 0, -st * sl));
          jacobian(row, at + 2 + c) = cosine;
        }
        difference[row] = observed(i, c) - model;
      }
  };
  for (int i = 0; i < iterations; ++i) {
    evaluate();
    // A minimum-norm step: the system may be singular.
    const Eigen::VectorXd step = jacobian.completeOrthogonalDecomposition().solve(difference);
    if (!step.allFinite()) break;
    unknown += step;
  }
  evaluate();
  MadsenFit fit;
  fit.ambient = unknown.head<3>().array();
  fit.direction.resize(3, lights);
  fit.power.resize(lights, 3);
  for (int k = 0; k < lights; ++k) {
    fit.direction.col(k) = direction_from_spherical({unknown[3 + 5 * k], unknown[4 + 5 * k]});
    fit.power.row(k) = unknown.segment<3>(5 + 5 * k).array().transpose();
  }
  fit.residual = difference.norm() / observed.matrix().norm();
  return fit;
}

}  // namespace lightwell::bench
