// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/light_placement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>

#include "lighting/decomposition/error_kernel.h"

namespace lightwell {
namespace {

constexpr int kMeansRounds = 10;
constexpr double kBrightExponent = 1.6;  // of radiance, for the starts that are drawn to what is bright

// Merged atoms are the same places to the map's own accuracy, several times faster.
constexpr int kLeastCoarseAtoms = 700;
constexpr int kCoarseAtomsPerLight = 12;

struct Plan {
  int starts, start_steps, coarse_steps, fine_steps;
};

Plan plan_for(Effort effort, int count) {
  if (effort == Effort::frame) return {count <= 96 ? 2 : 1, 20, count <= 96 ? 30 : 10, count <= 96 ? 10 : 4};
  // Few lights have few places that are nearly alike; many starts find the best of them.
  return {std::clamp(512 / count, 2, 24), 40, 80, 40};
}

// Lights as points with their weight as luminance.
struct Placement {
  std::vector<Vec3d> direction;
  Eigen::VectorXd weight;

  [[nodiscard]] int size() const { return static_cast<int>(direction.size()); }
  [[nodiscard]] Atoms as_points() const {
    Atoms points(size());
    for (int i = 0; i < size(); ++i)
      points.add(direction[static_cast<std::size_t>(i)], Rgbd::Constant(weight.size() > 0 ? weight[i] : 0),
                 0);
    points.finish();
    return points;
  }
};

MomentVector luminance_moments(const Atoms& atoms) {
  double sums[placement_kernel::kMoments * 3] = {};
  const float* w = atoms.luminance.data();
  const float* const weights[3] = {w, w, w};
  placement_kernel::kernels().add_moments(atoms.points(), weights, sums);
  MomentVector moments;
  for (int m = 0; m < placement_kernel::kMoments; ++m) moments[m] = sums[3 * m];
  return moments;
}

// What light of a distribution is worth at each light.
Eigen::VectorXd potential_at(const Placement& p, const Atoms& atoms, const MomentVector& moments) {
  const Atoms at = p.as_points();
  std::vector<double> out(at.x.size());
  auto places = at.points();
  places.count = p.size();
  placement_kernel::kernels().potential(atoms.points(), atoms.luminance.data(), kernel_shares(), places,
                                        out.data());
  Eigen::VectorXd b(p.size());
  for (int i = 0; i < p.size(); ++i)
    b[i] = out[static_cast<std::size_t>(i)] +
           moment_weight() * lambertian_moments(p.direction[static_cast<std::size_t>(i)]).dot(moments);
  return b;
}

Eigen::MatrixXd kernel_among(const std::vector<Vec3d>& d) {
  const auto n = static_cast<Eigen::Index>(d.size());
  Eigen::MatrixXd g(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j <= i; ++j)
      g(i, j) = g(j, i) = error_kernel(d[static_cast<std::size_t>(i)], d[static_cast<std::size_t>(j)]);
  g.diagonal().array() += kRidge;
  return g;
}

// argmin over w ≥ 0 of ½ wᵀGw − wᵀb to what a descent needs: lights that would be negative are taken out, round by round.
Eigen::VectorXd weights(const Eigen::MatrixXd& g, const Eigen::VectorXd& b) {
  std::vector<Eigen::Index> lit(static_cast<std::size_t>(b.size()));
  for (std::size_t i = 0; i < lit.size(); ++i) lit[i] = static_cast<Eigen::Index>(i);
  Eigen::VectorXd w = Eigen::VectorXd::Zero(b.size());
  while (!lit.empty()) {
    const Eigen::VectorXd solution = Eigen::MatrixXd(g(lit, lit)).llt().solve(Eigen::VectorXd(b(lit)));
    w.setZero();
    std::vector<Eigen::Index> left;
    for (std::size_t i = 0; i < lit.size(); ++i)
      if (solution[static_cast<Eigen::Index>(i)] > 0) {
        w[lit[i]] = solution[static_cast<Eigen::Index>(i)];
        left.push_back(lit[i]);
      }
    if (left.size() == lit.size()) break;
    lit = std::move(left);
  }
  return w;
}

class Descent {
 public:
  Descent(const Atoms& atoms, double theta_max_rad)
      : atoms_(atoms), moments_(luminance_moments(atoms)), theta_max_rad_(theta_max_rad) {}

  // Twice the cost but for the atoms' own part; weights are made the best ones.
  double settle(Placement& p) const {
    const Eigen::MatrixXd g = kernel_among(p.direction);
    const Eigen::VectorXd b = potential_at(p, atoms_, moments_);
    p.weight = weights(g, b);
    return p.weight.dot(g * p.weight) - 2 * p.weight.dot(b);
  }

  // Steps that grow while a light's direction holds and shrink when it turns (resilient descent); weights are found anew
  // every tenth step.
  void run(Placement& p, int steps) const {
    const auto& kernel = placement_kernel::kernels();
    const auto n = static_cast<std::size_t>(p.size());
    std::vector<double> step = first_steps(p.direction);
    std::vector<Vec3d> before(n, Vec3d::Zero());
    std::vector<double> of_map(4 * n + 32), of_lights(4 * n + 32);
    for (int iteration = 0; iteration < steps; ++iteration) {
      if (iteration % 10 == 0) settle(p);
      const Atoms lights = p.as_points();
      auto places = lights.points();
      places.count = p.size();
      kernel.gradient(atoms_.points(), atoms_.luminance.data(), kernel_shares(), places, of_map.data());
      kernel.gradient(lights.points(), lights.luminance.data(), kernel_shares(), places, of_lights.data());
      const MomentVector missing = moments_ - luminance_moments(lights);
      for (std::size_t i = 0; i < n; ++i) {
        Vec3d& d = p.direction[i];
        Vec3d way(of_map[4 * i] - of_lights[4 * i], of_map[4 * i + 1] - of_lights[4 * i + 1],
                  of_map[4 * i + 2] - of_lights[4 * i + 2]);
        way.y() += kGroundShare * ground_share_slope(d.y()) * (of_map[4 * i + 3] - of_lights[4 * i + 3]);
        way += moment_gradient(d, missing);
        way -= way.dot(d) * d;
        way /= std::max(way.norm(), 1e-300);
        const double turn = way.dot(before[i]);
        step[i] = std::clamp(step[i] * (turn > 0.3 ? 1.2 : turn < -0.1 ? 0.5 : 0.95), 1e-6, 0.15);
        before[i] = way;
        d = inside_cap(d + step[i] * way);
      }
    }
  }

 private:
  [[nodiscard]] Vec3d inside_cap(Vec3d d) const {
    d.normalize();
    const double limit = theta_max_rad_ - 1e-4;  // a light on the horizon itself would light nothing
    if (theta_max_rad_ >= kPi || d.y() >= std::cos(limit)) return d;
    return direction_from_spherical({limit, spherical_from_direction(d).lambda_rad});
  }

  // A quarter of the way to the nearest neighbour.
  static std::vector<double> first_steps(const std::vector<Vec3d>& d) {
    std::vector<double> step(d.size(), 0.1);
    for (std::size_t i = 0; i < d.size(); ++i) {
      double nearest = 4;
      for (std::size_t j = 0; j < d.size(); ++j)
        if (j != i) nearest = std::min(nearest, (d[i] - d[j]).squaredNorm());
      if (d.size() > 1) step[i] = 0.25 * std::sqrt(std::max(nearest, 1e-8));
    }
    return step;
  }

  const Atoms& atoms_;
  MomentVector moments_;
  double theta_max_rad_;
};

// Spherical k-means (Lloyd) on weighted atoms; a light that no atom is nearest to goes where an atom is served worst.
void k_means(Placement& p, const Atoms& atoms, double exponent) {
  const auto n = static_cast<std::size_t>(p.size());
  const auto count = static_cast<std::size_t>(atoms.count);
  std::vector<double> weight(count);
  for (std::size_t k = 0; k < count; ++k) {
    const auto omega = static_cast<double>(atoms.solid_angle_sr[k]);
    weight[k] = omega * std::pow(static_cast<double>(atoms.luminance[k]) / omega, exponent);
  }
  std::vector<int> nearest(atoms.x.size());
  std::vector<float> distance(atoms.x.size());
  for (int round = 0; round < kMeansRounds; ++round) {
    const Atoms lights = p.as_points();
    auto places = lights.points();
    places.count = p.size();
    placement_kernel::kernels().nearest(atoms.points(), places, nearest.data(), distance.data());
    std::vector<Vec3d> moment(n, Vec3d::Zero());
    for (std::size_t k = 0; k < count; ++k)
      moment[static_cast<std::size_t>(nearest[k])] += weight[k] * atoms.direction(static_cast<int>(k));
    for (std::size_t i = 0; i < n; ++i) {
      const double length = moment[i].norm();
      if (length > 0) {
        p.direction[i] = moment[i] / length;
        continue;
      }
      std::size_t worst = 0;
      for (std::size_t k = 0; k < count; ++k)
        if (weight[k] * static_cast<double>(distance[k]) >
            weight[worst] * static_cast<double>(distance[worst]))
          worst = k;
      p.direction[i] = atoms.direction(static_cast<int>(worst));
      distance[worst] = 0;
    }
  }
}

// The first two starts divide the light evenly, further ones draw it by chance.
Placement start(const Atoms& atoms, int count, int number, std::mt19937_64& random) {
  Placement p;
  if (number < 2) {
    const Atoms groups = merge_atoms(atoms, count);
    for (int i = 0; i < count; ++i) p.direction.push_back(groups.direction(std::min(i, groups.count - 1)));
  } else {
    std::vector<double> sums;
    double sum = 0;
    for (int k = 0; k < atoms.count; ++k)
      sums.push_back(sum += static_cast<double>(atoms.luminance[static_cast<std::size_t>(k)]));
    for (int i = 0; i < count; ++i) {
      const double at = static_cast<double>(random() >> 11) * 0x1p-53 * sum;
      const auto k = std::upper_bound(sums.begin(), sums.end() - 1, at) - sums.begin();
      p.direction.push_back(atoms.direction(static_cast<int>(k)));
    }
  }
  k_means(p, atoms, number % 2 == 0 ? 1 : kBrightExponent);
  return p;
}

}  // namespace

std::vector<Vec3d> place_lights(const Atoms& atoms, int count, double theta_max_rad, Effort effort) {
  const Plan plan = plan_for(effort, count);
  const Atoms coarse = merge_atoms(atoms, std::max(kLeastCoarseAtoms, kCoarseAtomsPerLight * count));
  const Descent on_coarse(coarse, theta_max_rad);
  std::mt19937_64 random(1);
  Placement best;
  double least = 0;
  for (int number = 0; number < plan.starts; ++number) {
    Placement p = start(coarse, count, number, random);
    on_coarse.run(p, plan.start_steps);
    const double cost = on_coarse.settle(p);
    if (best.size() == 0 || cost < least) {
      best = std::move(p);
      least = cost;
    }
  }
  on_coarse.run(best, plan.coarse_steps);
  Descent(atoms, theta_max_rad).run(best, plan.fine_steps);
  return best.direction;
}

std::vector<Vec3d> descend_lights(const Atoms& atoms, std::vector<Vec3d> lights, double theta_max_rad,
                                  int steps) {
  Placement p{std::move(lights), {}};
  Descent(atoms, theta_max_rad).run(p, steps);
  return p.direction;
}

}  // namespace lightwell
