// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/triangulation.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace lightwell {
namespace {

constexpr double kSigma_rad = 0.4 * kPi / 180;  // of a centroid of bins of 1°, and of a probe's own tilt
constexpr int kSteps = 4;  // the angles are nearly linear: two are enough but for bad guesses

}  // namespace

std::optional<Vec3d> meeting_point(const SightRay& a, const SightRay& b, double least_m) {
  const Vec3d between = b.origin - a.origin;
  const double cosine = a.direction.dot(b.direction), square_sine = 1 - cosine * cosine;
  if (square_sine < std::pow(std::sin(3 * kPi / 180), 2)) return std::nullopt;
  const double along_a = between.dot(a.direction), along_b = between.dot(b.direction);
  const double ta = (along_a - cosine * along_b) / square_sine,
               tb = (cosine * along_a - along_b) / square_sine;
  if (ta < least_m || tb < least_m) return std::nullopt;
  return (a.origin + ta * a.direction + b.origin + tb * b.direction) / 2;
}

std::optional<LampPlace> triangulate(std::span<const SightRay> rays, const Vec3d& guess) {
  if (rays.size() < 2) return std::nullopt;
  LampPlace place{guess, 0, 0};
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (int step = 0; step < kSteps; ++step) {
    information.setZero();
    Vec3d right = Vec3d::Zero();
    for (const SightRay& ray : rays) {
      const double square = std::max((place.position - ray.origin).squaredNorm(), 1e-6);
      const Eigen::Matrix3d across =
          (Eigen::Matrix3d::Identity() - ray.direction * ray.direction.transpose()) / square;
      information += across;
      right += across * ray.origin;
    }
    const Eigen::LDLT<Eigen::Matrix3d> factors(information);
    if (factors.info() != Eigen::Success) return std::nullopt;
    place.position = factors.solve(right);
    if (!place.position.allFinite()) return std::nullopt;
  }
  double squares = 0;
  for (const SightRay& ray : rays) {
    const Vec3d toward = place.position - ray.origin;
    if (!(toward.dot(ray.direction) > 0)) return std::nullopt;
    const double angle = std::atan2(toward.cross(ray.direction).norm(), toward.dot(ray.direction));
    squares += angle * angle;
  }
  place.residual_rad = std::sqrt(squares / static_cast<double>(rays.size()));
  // 2 n angles less three unknowns.
  const double degrees = std::max(2.0 * static_cast<double>(rays.size()) - 3, 1.0);
  const double sigma = std::max(kSigma_rad, std::sqrt(squares / degrees));
  const double least =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(information, Eigen::EigenvaluesOnly).eigenvalues()[0];
  if (!(least > 0)) return std::nullopt;
  place.sigma_m = sigma / std::sqrt(least);
  return place;
}

}  // namespace lightwell
