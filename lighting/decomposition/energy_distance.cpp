// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/energy_distance.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

namespace lightwell {
namespace {

constexpr double kSoftening = 0.5 * kPi / 180;
constexpr double kSquaredAtZero =
    2 + kSoftening * kSoftening;  // |a − b|² + ε² = 2 + ε² − 2 a·b on the unit sphere
constexpr double kConstant = 3;   // above any mean distance: 3 − r stays definite
constexpr double kRidge = 1e-6;   // two lights in one place share their weight

// Directions and weights as floats, coordinate by coordinate: only the direction of a step comes from them,
// and four of them fit where two doubles do.
struct Sources {
  Eigen::ArrayXf x, y, z, weight;

  Sources(const Directions& d, const Eigen::VectorXd& w)
      : x(d.row(0).transpose().cast<float>()),
        y(d.row(1).transpose().cast<float>()),
        z(d.row(2).transpose().cast<float>()),
        weight(w.cast<float>()) {}
};

// Σ weight / distance · direction, for each light: the tangential part is the pull toward those directions.
Directions pull(const Directions& lights, const Sources& from) {
  constexpr Eigen::Index kChunk = 512;  // five arrays of it stay in the first level cache
  Directions force = Directions::Zero(3, lights.cols());
  Eigen::Array<float, kChunk, 1> scratch;
  for (Eigen::Index begin = 0; begin < from.x.size(); begin += kChunk) {
    const Eigen::Index count = std::min(kChunk, from.x.size() - begin);
    const auto x = from.x.segment(begin, count);
    const auto y = from.y.segment(begin, count);
    const auto z = from.z.segment(begin, count);
    auto strength = scratch.head(count);
    for (Eigen::Index i = 0; i < lights.cols(); ++i) {
      const Vec3f d = (-2 * lights.col(i)).cast<float>();
      constexpr auto kOffset = static_cast<float>(kSquaredAtZero);
      constexpr auto kLeast = static_cast<float>(kSoftening * kSoftening);
      strength = from.weight.segment(begin, count) /
                 (x * d.x() + y * d.y() + z * d.z() + kOffset).max(kLeast).sqrt();
      force.col(i) += Vec3d((strength * x).sum(), (strength * y).sum(), (strength * z).sum());
    }
  }
  return force;
}

// Mean distance of the atoms' luminance from each light.
Eigen::VectorXd luminance_potential(const Directions& lights, const Atoms& atoms) {
  return softened_distances(lights, atoms.direction) * atoms.luminance;
}

Vec3d inside_cap(Vec3d d, double theta_max_rad) {
  d.normalize();
  const double limit = theta_max_rad - 1e-4;  // a light on the horizon itself would light nothing
  if (theta_max_rad >= kPi || d.y() >= std::cos(limit)) return d;
  return direction_from_spherical({limit, spherical_from_direction(d).lambda_rad});
}

// A step for every light: a quarter of the way to its nearest neighbour.
Eigen::VectorXd first_steps(const Directions& d) {
  Eigen::VectorXd step = Eigen::VectorXd::Constant(d.cols(), 0.1);
  for (Eigen::Index i = 0; i < d.cols(); ++i) {
    double nearest = 4;
    for (Eigen::Index j = 0; j < d.cols(); ++j)
      if (j != i) nearest = std::min(nearest, (d.col(i) - d.col(j)).squaredNorm());
    if (d.cols() > 1) step[i] = 0.25 * std::sqrt(std::max(nearest, 1e-8));
  }
  return step;
}

}  // namespace

Eigen::MatrixXd softened_distances(const Directions& a, const Directions& b) {
  Eigen::MatrixXd squared = (-2 * a.transpose()) * b;
  return (squared.array() + kSquaredAtZero).max(kSoftening * kSoftening).sqrt().matrix();
}

Eigen::VectorXd nearest_weights(const Eigen::MatrixXd& distances, const Eigen::VectorXd& potential,
                                const Eigen::VectorXd& start) {
  // Block principal pivoting (Portugal, Júdice and Vicente 1994): solve on the active set, exchange all that
  // violate w ≥ 0 or gradient ≥ 0, and only the last of them while their number does not fall.
  const Eigen::Index n = potential.size();
  std::vector<bool> active(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) active[static_cast<std::size_t>(i)] = start[i] > 0;
  if (std::find(active.begin(), active.end(), true) == active.end()) active.assign(active.size(), true);
  const Eigen::VectorXd right = (kConstant - potential.array()).matrix();
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(n);
  std::size_t fewest = active.size() + 1;
  int patience = 4;
  for (int iteration = 0; iteration < 60; ++iteration) {
    std::vector<Eigen::Index> set;
    for (Eigen::Index i = 0; i < n; ++i)
      if (active[static_cast<std::size_t>(i)]) set.push_back(i);
    Eigen::MatrixXd matrix = (kConstant - distances(set, set).array()).matrix();
    matrix.diagonal().array() += kRidge;
    const Eigen::VectorXd solution = matrix.llt().solve(Eigen::VectorXd(right(set)));
    weight.setZero();
    weight(set) = solution;
    const Eigen::VectorXd gradient = weight.sum() * kConstant - (distances * weight).array() - right.array();
    std::vector<Eigen::Index> violating;
    for (Eigen::Index i = 0; i < n; ++i)
      if (active[static_cast<std::size_t>(i)] ? weight[i] <= 0 : gradient[i] < -1e-10) violating.push_back(i);
    if (violating.empty()) break;
    if (violating.size() < fewest) {
      fewest = violating.size();
      patience = 4;
    } else if (--patience < 0) {
      violating = {violating.back()};
    }
    for (const Eigen::Index i : violating)
      active[static_cast<std::size_t>(i)] = !active[static_cast<std::size_t>(i)];
    if (std::find(active.begin(), active.end(), true) == active.end()) active.assign(active.size(), true);
  }
  weight = weight.cwiseMax(0);
  const double sum = weight.sum();
  if (!(sum > 0) || !std::isfinite(sum)) return Eigen::VectorXd::Constant(n, 1.0 / static_cast<double>(n));
  return weight / sum;
}

double energy(const Placement& p, const Atoms& atoms) {
  const Eigen::VectorXd potential = luminance_potential(p.direction, atoms);
  return 2 * p.weight.dot(potential) - p.weight.dot(softened_distances(p.direction, p.direction) * p.weight);
}

Placement descend(Placement p, const Atoms& atoms, double theta_max_rad, int steps) {
  const Eigen::Index n = p.direction.cols();
  Eigen::VectorXd step = first_steps(p.direction);
  Directions before = Directions::Zero(3, n);
  const Sources map(atoms.direction, atoms.luminance);
  for (int iteration = 0; iteration < steps; ++iteration) {
    if (iteration % 10 == 0)
      p.weight = nearest_weights(softened_distances(p.direction, p.direction),
                                 luminance_potential(p.direction, atoms), p.weight);
    const Directions downhill = pull(p.direction, map) - pull(p.direction, Sources(p.direction, p.weight));
    for (Eigen::Index i = 0; i < n; ++i) {
      Vec3d d = p.direction.col(i);
      Vec3d way = downhill.col(i) - downhill.col(i).dot(d) * d;
      way /= std::max(way.norm(), 1e-300);
      const double turn = way.dot(before.col(i));
      step[i] = std::clamp(step[i] * (turn > 0.3 ? 1.2 : turn < -0.1 ? 0.5 : 0.95), 1e-6, 0.15);
      before.col(i) = way;
      p.direction.col(i) = inside_cap(d + step[i] * way, theta_max_rad);
    }
  }
  p.weight = nearest_weights(softened_distances(p.direction, p.direction),
                             luminance_potential(p.direction, atoms), p.weight);
  return p;
}

}  // namespace lightwell
