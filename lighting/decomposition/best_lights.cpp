// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/best_lights.h"

#include <algorithm>
#include <cmath>

#include "lighting/decomposition/atoms.h"
#include "lighting/decomposition/energy_distance.h"
#include "lighting/decomposition/median_cut.h"
#include "lighting/decomposition/moment_match.h"
#include "lighting/decomposition/split_tree.h"

namespace lightwell {
namespace {

using Powers = Eigen::Matrix<double, Eigen::Dynamic, 3>;

constexpr int kMeansRounds = 12;
// Most of the way is gone on merged atoms: the same places to the map's own accuracy, five times faster.
constexpr Eigen::Index kLeastCoarseAtoms = 700;
constexpr Eigen::Index kCoarseAtomsPerLight = 12;
constexpr int kStartSteps = 40;          // each start, on merged atoms
constexpr int kCoarseSteps = 60;         // the better one, on merged atoms
constexpr int kFineSteps = 20;           // on all atoms
constexpr double kBrightExponent = 1.6;  // of radiance, for the start that is drawn to what is bright

// Spherical k-means (Lloyd) on weighted atoms; a light that no atom is nearest to goes where an atom is
// served worst.
Directions k_means(Directions lights, const Atoms& atoms, const Eigen::VectorXd& weight) {
  for (int round = 0; round < kMeansRounds; ++round) {
    Directions moment = Directions::Zero(3, lights.cols());
    const Eigen::MatrixXd cosine = lights.transpose() * atoms.direction;
    Eigen::VectorXd badness(atoms.size());
    for (Eigen::Index k = 0; k < atoms.size(); ++k) {
      Eigen::Index nearest = 0;
      const double best = cosine.col(k).maxCoeff(&nearest);
      moment.col(nearest) += weight[k] * atoms.direction.col(k);
      badness[k] = weight[k] * (1 - best);
    }
    for (Eigen::Index i = 0; i < lights.cols(); ++i) {
      const double length = moment.col(i).norm();
      if (length > 0) {
        lights.col(i) = moment.col(i) / length;
        continue;
      }
      Eigen::Index worst = 0;
      badness.maxCoeff(&worst);
      badness[worst] = 0;
      lights.col(i) = atoms.direction.col(worst);
    }
  }
  return lights;
}

Directions place(const Atoms& atoms, Eigen::Index count, double theta_max_rad) {
  const Atoms coarse = merge_atoms(atoms, std::max(kLeastCoarseAtoms, kCoarseAtomsPerLight * count));
  const Directions start = merge_atoms(atoms, count).direction;
  const Eigen::ArrayXd radiance = coarse.luminance.array() / coarse.solid_angle_sr.array();
  const double mean = radiance.mean();
  Placement best;
  double least = 0;
  for (const double exponent : {1.0, kBrightExponent}) {
    const Eigen::VectorXd weight = (coarse.solid_angle_sr.array() * (radiance / mean).pow(exponent)).matrix();
    Placement p{k_means(start, coarse, weight), Eigen::VectorXd::Ones(start.cols())};
    p = descend(std::move(p), coarse, theta_max_rad, kStartSteps);
    const double e = energy(p, coarse);
    if (best.weight.size() == 0 || e < least) {
      best = std::move(p);
      least = e;
    }
  }
  best = descend(std::move(best), coarse, theta_max_rad, kCoarseSteps);
  return descend(std::move(best), atoms, theta_max_rad, kFineSteps).direction;
}

Powers powers_at(const Directions& lights, const Atoms& atoms) {
  const Eigen::MatrixXd to_atoms = softened_distances(lights, atoms.direction);
  const Eigen::MatrixXd among = softened_distances(lights, lights);
  Powers powers = Powers::Zero(lights.cols(), 3);
  Eigen::VectorXd start = Eigen::VectorXd::Ones(lights.cols());
  for (int c = 0; c < 3; ++c) {
    const double total = atoms.illuminance.col(c).sum();
    if (!(total > 0)) continue;
    start = nearest_weights(among, to_atoms * atoms.illuminance.col(c) / total, start);
    powers.col(c) = start * total;
  }
  match_moments(lights, lambertian_moments(atoms.direction) * atoms.illuminance, powers);
  return powers;
}

std::vector<DirectionalLight> as_lights(const Directions& directions, const Powers& powers,
                                        const Rgbd& total) {
  std::vector<DirectionalLight> lights(static_cast<std::size_t>(directions.cols()));
  const Rgbd sum = powers.colwise().sum().transpose().array();
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    lights[i].direction = directions.col(k).normalized().cast<float>();
    for (int c = 0; c < 3; ++c)
      lights[i].illuminance[c] = sum[c] > 0 ? static_cast<float>(powers(k, c) * (total[c] / sum[c])) : 0.0f;
  }
  return lights;
}

}  // namespace

std::vector<DirectionalLight> best_lights(const PolarMap& map, int count) {
  if (count > kMostPlacedLights) return median_cut(map, count);
  // More lights resolve more: the atoms stay several times finer than what the lights can show.
  const Atoms atoms = make_atoms(map, {1.0 / std::max(1500, 10 * count), 1.0 / std::max(800, 5 * count)});
  if (atoms.size() == 0) return median_cut(map, count);
  if (atoms.size() > count) {
    const Directions lights = place(atoms, count, map.grid.theta_max_rad);
    return progressive_order(as_lights(lights, powers_at(lights, atoms), atoms.total));
  }
  std::vector<DirectionalLight> lights = as_lights(atoms.direction, atoms.illuminance, atoms.total);
  DirectionalLight dark = lights.front();
  dark.illuminance = Rgb::Zero();
  lights.resize(static_cast<std::size_t>(count), dark);
  return progressive_order(lights);
}

}  // namespace lightwell
