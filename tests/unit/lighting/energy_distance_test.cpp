// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/energy_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lighting/decomposition/atoms.h"
#include "lighting/decomposition/moment_match.h"
#include "lighting/decomposition/split_tree.h"

namespace lightwell {
namespace {

Directions random_directions(Eigen::Index count, unsigned seed, bool upper = false) {
  Directions d(3, count);
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  for (Eigen::Index i = 0; i < count; ++i) {
    d.col(i) = Vec3d(normal(generator), normal(generator), normal(generator)).normalized();
    if (upper) d(1, i) = std::abs(d(1, i));
  }
  return d;
}

Eigen::VectorXd random_weights(Eigen::Index count, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  Eigen::VectorXd w(count);
  for (double& value : w) value = std::pow(uniform(generator), 4);
  return w / w.sum();
}

Atoms random_atoms(Eigen::Index count) {
  Atoms atoms;
  atoms.direction = random_directions(count, 1, true);
  atoms.luminance = random_weights(count, 2);
  atoms.illuminance = atoms.luminance * Eigen::RowVector3d(1, 1, 1);
  atoms.solid_angle_sr = Eigen::VectorXd::Constant(count, 2 * kPi / static_cast<double>(count));
  atoms.scale = 1;
  atoms.total = Rgbd::Ones();
  return atoms;
}

double objective(const Eigen::MatrixXd& distances, const Eigen::VectorXd& potential,
                 const Eigen::VectorXd& w) {
  return 0.5 * w.dot((3 - distances.array()).matrix() * w) - w.dot((3 - potential.array()).matrix());
}

TEST(NearestWeights, RecoverADistributionThatTheLightsCanShow) {
  const Directions lights = random_directions(40, 3);
  const Eigen::MatrixXd distances = softened_distances(lights, lights);
  const Eigen::VectorXd truth = random_weights(40, 4);
  const Eigen::VectorXd found = nearest_weights(distances, distances * truth, Eigen::VectorXd::Ones(40));
  EXPECT_LT((found - truth).cwiseAbs().maxCoeff(),
            1e-4);  // the ridge of 1e-6 against the matrix' least eigenvalues
}

TEST(NearestWeights, AreFeasibleAndNoFeasibleNeighbourIsBetter) {
  const Atoms atoms = random_atoms(500);
  const Directions lights =
      random_directions(60, 5);  // half of them below, where no atom is: zeros are active
  const Eigen::MatrixXd distances = softened_distances(lights, lights);
  const Eigen::VectorXd potential = softened_distances(lights, atoms.direction) * atoms.luminance;
  const Eigen::VectorXd w = nearest_weights(distances, potential, Eigen::VectorXd::Ones(60));
  EXPECT_NEAR(w.sum(), 1, 1e-12);
  EXPECT_GE(w.minCoeff(), 0);
  EXPECT_EQ(w.minCoeff(), 0);
  const double least = objective(distances, potential, w);
  for (Eigen::Index i = 0; i < 60; ++i)
    for (Eigen::Index j = 0; j < 60; ++j) {
      Eigen::VectorXd moved = w;  // some weight from i to j: the sum stays
      const double amount = std::min(w[i], 1e-3);
      moved[i] -= amount;
      moved[j] += amount;
      EXPECT_GT(objective(distances, potential, moved), least - 1e-8);  // the ridge
    }
}

TEST(Descent, LowersTheEnergyAndStaysInTheCap) {
  const Atoms atoms = random_atoms(800);
  Placement p{random_directions(20, 6, true), Eigen::VectorXd::Ones(20)};
  p = descend(std::move(p), atoms, kPi / 2, 0);
  const double before = energy(p, atoms);
  p = descend(std::move(p), atoms, kPi / 2, 100);
  EXPECT_LT(energy(p, atoms), before - 1e-4);
  for (Eigen::Index i = 0; i < 20; ++i) {
    EXPECT_GT(p.direction(1, i), 0);
    EXPECT_NEAR(p.direction.col(i).norm(), 1, 1e-12);
  }
}

TEST(Descent, TwoLightsFindTwoSources) {
  Atoms atoms = random_atoms(2);
  atoms.direction.col(0) = Vec3d(0.6, 0.8, 0);
  atoms.direction.col(1) = Vec3d(0, 0.6, 0.8);
  atoms.luminance = Eigen::Vector2d(0.3, 0.7);
  Placement p{random_directions(2, 12, true), Eigen::VectorXd::Ones(2)};
  p = descend(std::move(p), atoms, kPi / 2, 300);
  const Eigen::MatrixXd distances = softened_distances(p.direction, atoms.direction);
  EXPECT_LT(distances.colwise().minCoeff().maxCoeff(), 0.012);  // the softening itself is 0.0087
}

TEST(LambertianMoments, GiveTheIrradianceOfEveryNormal) {
  // max(0, n·d) = Σ moments(d) · Y(n): orthonormal harmonics, so moments · moments / factor² sums to the
  // cosine's expansion to degree 4, which is within 3 % of it in the mean (Ramamoorthi and Hanrahan 2001).
  const Directions d = random_directions(400, 7);
  const Eigen::MatrixXd m = lambertian_moments(d);
  const double factor[] = {kPi, 2 * kPi / 3, kPi / 4, -kPi / 24};
  Eigen::VectorXd inverse(18);
  for (int i = 0; i < 18; ++i) inverse[i] = 1 / factor[i < 1 ? 0 : i < 4 ? 1 : i < 9 ? 2 : 3];
  const Eigen::MatrixXd cosine = m.transpose() * inverse.asDiagonal() * m;
  for (Eigen::Index i = 0; i < 400; ++i)
    for (Eigen::Index j = 0; j < 400; ++j) {
      const double exact = d.col(i).dot(d.col(j));
      // closed form of the expansion at angle acos(exact): Σ (2l+1)/(4π) A_l P_l
      const double c = exact, p2 = (3 * c * c - 1) / 2, p4 = (35 * c * c * c * c - 30 * c * c + 3) / 8;
      const double series =
          (1 * kPi + 3 * (2 * kPi / 3) * c + 5 * (kPi / 4) * p2 + 9 * (-kPi / 24) * p4) / (4 * kPi);
      EXPECT_NEAR(cosine(i, j), series, 1e-12);  // the addition theorem: the 18 functions are a full basis
      EXPECT_NEAR(series, std::max(0.0, exact), 0.06);
    }
}

TEST(MatchMoments, BringsPowersCloserToTheTarget) {
  const Atoms atoms = random_atoms(600);
  const Directions lights = random_directions(40, 9, true);
  const Eigen::MatrixXd target = lambertian_moments(atoms.direction) * atoms.illuminance;
  Eigen::Matrix<double, Eigen::Dynamic, 3> power = Eigen::MatrixXd::Constant(40, 3, 1.0 / 40);
  const auto missing = [&] { return (lambertian_moments(lights) * power - target).norm(); };
  const double before = missing();
  match_moments(lights, target, power);
  EXPECT_LT(missing(), 0.1 * before);
  EXPECT_GT(power.minCoeff(), 0);
}

TEST(Atoms, KeepTheMapsPowerAndAreFew) {
  PolarMap map = PolarMap::make({256, 1024, kPi / 2}, 3);
  std::mt19937 generator(1);
  std::uniform_real_distribution<float> exponent(-3, 1);
  for (float& value : map.radiance) value = std::pow(10.0f, exponent(generator));
  map.plane(0)[5] = 1e6f;
  const Atoms atoms = make_atoms(map);
  EXPECT_LT(atoms.size(), 8000);
  EXPECT_GT(atoms.size(), 300);
  const Rgbd sum = atoms.illuminance.colwise().sum().transpose().array() * atoms.scale;
  EXPECT_LT(((sum - total_illuminance(map)) / sum).abs().maxCoeff(),
            1e-10);  // double rounding of 262,144 bins
  EXPECT_NEAR(atoms.luminance.sum(), 1, 1e-10);
  EXPECT_NEAR(atoms.solid_angle_sr.sum(), 2 * kPi, 1e-4);  // floats; no block is black
  const Atoms merged = merge_atoms(atoms, 100);
  EXPECT_EQ(merged.size(), 100);
  EXPECT_NEAR(merged.luminance.sum(), 1, 1e-10);
  EXPECT_LT((merged.illuminance.colwise().sum() - atoms.illuminance.colwise().sum()).norm(), 1e-10);
}

TEST(Atoms, OneBurningBinKeepsItsPlace) {
  PolarMap map = PolarMap::make({256, 1024, kPi / 2}, 1);
  for (float& value : map.radiance) value = 1;
  map.radiance[100 * 1024 + 333] = 1e7f;
  const Atoms atoms = make_atoms(map);
  Eigen::Index brightest = 0;
  atoms.luminance.maxCoeff(&brightest);
  EXPECT_LT((atoms.direction.col(brightest) - map.grid.bin_direction(100, 333)).norm(),
            1e-5);  // 1e-7 of it is sky
}

TEST(Atoms, WhatIsNotLightCountsAsNone) {
  PolarMap map = PolarMap::make({10, 10, kPi / 2}, 1);
  map.radiance[3] = -1;
  map.radiance[4] = std::nanf("");
  map.radiance[5] = INFINITY;
  EXPECT_EQ(make_atoms(map).size(), 0);
  map.radiance[6] = 2;
  EXPECT_EQ(make_atoms(map).size(), 1);
}

TEST(ProgressiveOrder, HoldsAllLightsAndFoldsThePairThatCostsLeast) {
  std::vector<DirectionalLight> lights;
  const Directions d = random_directions(30, 10);
  const Eigen::VectorXd w = random_weights(30, 11);
  for (Eigen::Index i = 0; i < 30; ++i)
    lights.push_back(
        {d.col(i).cast<float>(), Rgb::Constant(static_cast<float>(w[i])), -1, static_cast<std::uint32_t>(i)});
  LightSet set;
  set.has_parents = true;
  set.lights = progressive_order(lights);
  std::vector<bool> seen(30, false);
  for (const auto& light : set.lights) seen[light.id] = true;
  EXPECT_EQ(std::count(seen.begin(), seen.end(), true), 30);
  // The last light and its parent are the cheapest pair by exhaustive search.
  double least = 1e9;
  std::pair<Eigen::Index, Eigen::Index> pair;
  for (Eigen::Index i = 0; i < 30; ++i)
    for (Eigen::Index j = 0; j < i; ++j)
      if (const double cost = w[i] * w[j] * (d.col(i) - d.col(j)).norm(); cost < least) {
        least = cost;
        pair = {j, i};
      }
  const auto last = static_cast<Eigen::Index>(set.lights.back().id);
  const auto parent =
      static_cast<Eigen::Index>(set.lights[static_cast<std::size_t>(set.lights.back().parent)].id);
  EXPECT_EQ(std::minmax(last, parent), std::minmax(pair.first, pair.second));
  EXPECT_GE(w[parent], w[last]);
  EXPECT_TRUE(progressive_order({}).empty());
}

}  // namespace
}  // namespace lightwell
