// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/persistent_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <random>
#include <vector>

#include "lighting/decomposition/error_kernel.h"
#include "tests/support/directions.h"

namespace lightwell::test {
namespace {

struct Scene {
  std::vector<Vec3d> directions;
  std::vector<double> powers;
  std::vector<double> kernel;

  Scene(int n, unsigned seed)
      : directions(random_directions(n, seed, true)), powers(random_powers(n, seed + 1)) {
    kernel.resize(directions.size() * directions.size());
    for (int i = 0; i < n; ++i) place(i);
  }
  void place(int i) {
    const std::size_t n = directions.size(), a = static_cast<std::size_t>(i);
    for (std::size_t b = 0; b < n; ++b)
      kernel[a * n + b] = kernel[b * n + a] = error_kernel(directions[a], directions[b]);
  }
  PersistentTree::Lights lights() const {
    return {directions, powers, kernel.data(), static_cast<int>(directions.size())};
  }
};

void expect_a_tree_of_all(const PersistentTree& tree, std::size_t n) {
  const auto order = tree.order();
  ASSERT_EQ(order.size(), n);
  std::vector<int> seen;
  for (std::size_t i = 0; i < n; ++i) {
    seen.push_back(order[i].light);
    if (i == 0)
      EXPECT_EQ(order[i].parent, -1);
    else
      EXPECT_TRUE(order[i].parent >= 0 && order[i].parent < static_cast<int>(i));
  }
  std::sort(seen.begin(), seen.end());
  for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(seen[i], static_cast<int>(i));
}

TEST(PersistentTree, HoldsAllLightsWhateverMoves) {
  for (const int n : {1, 2, 3, 16, 65}) {
    Scene scene(n, 1);
    PersistentTree tree(n);
    tree.build(scene.lights());
    expect_a_tree_of_all(tree, static_cast<std::size_t>(n));
    std::mt19937 random(2);
    const auto places = random_directions(600, 3, true);
    for (std::size_t frame = 0; frame < 200; ++frame) {
      std::vector<int> moved;
      for (int k = 0; k < 3; ++k) {
        const int light = static_cast<int>(random() % static_cast<unsigned>(n));
        if (std::find(moved.begin(), moved.end(), light) != moved.end()) continue;
        scene.directions[static_cast<std::size_t>(light)] = places[3 * frame + static_cast<std::size_t>(k)];
        scene.place(light);
        moved.push_back(light);
      }
      scene.powers[random() % static_cast<unsigned>(n)] = frame % 5 == 0 ? 0 : 0.1;
      tree.follow(scene.lights(), moved);
      expect_a_tree_of_all(tree, static_cast<std::size_t>(n));
    }
  }
}

TEST(PersistentTree, KeepsItsOrderWhereANewOneWouldNot) {
  Scene scene(64, 5);
  PersistentTree tree(64), anew(64);
  tree.build(scene.lights());
  const auto order_of = [](const PersistentTree& t) {
    std::vector<std::pair<int, int>> list;
    for (const auto& entry : t.order()) list.emplace_back(entry.light, entry.parent);
    return list;
  };
  for (int settle = 0; settle < 5; ++settle) tree.follow(scene.lights(), {});
  auto before = order_of(tree), before_anew = before;
  std::mt19937 random(6);
  std::normal_distribution<double> noise(1, 0.02);
  const auto powers = scene.powers;
  int changes = 0, changes_anew = 0;
  for (int frame = 0; frame < 150; ++frame) {
    for (std::size_t i = 0; i < 64; ++i) scene.powers[i] = powers[i] * std::max(0.0, noise(random));
    tree.follow(scene.lights(), {});
    anew.build(scene.lights());
    // What stands near a threshold passes it once: the first frames find that out.
    changes += frame >= 100 && order_of(tree) != before;
    changes_anew += frame >= 100 && order_of(anew) != before_anew;
    before = order_of(tree);
    before_anew = order_of(anew);
  }
  EXPECT_LE(changes, 5);
  EXPECT_GE(changes_anew, 40);  // 2 % of noise decides between nearly equal divisions
}

// ½ δᵀ k δ of δ = the group's lights − one light of their power at their mean, pair by pair.
double cost_of_one_for_all(const Scene& scene, const std::vector<std::size_t>& group) {
  Vec3d moment = Vec3d::Zero();
  double power = 0;
  for (const std::size_t i : group) {
    moment += scene.powers[i] * scene.directions[i];
    power += scene.powers[i];
  }
  if (!(power > 0)) return 0;
  std::vector<Vec3d> places = {moment.normalized()};
  std::vector<double> delta = {-power};
  for (const std::size_t i : group) {
    places.push_back(scene.directions[i]);
    delta.push_back(scene.powers[i]);
  }
  double form = 0;
  for (std::size_t a = 0; a < places.size(); ++a)
    for (std::size_t b = 0; b < places.size(); ++b)
      form += delta[a] * delta[b] * error_kernel(places[a], places[b]);
  return form / 2;
}

// Each light that is left out belongs to the group of the entry among the first n that its parents lead to.
double cost_of_the_first(std::size_t n, const PersistentTree& tree, const Scene& scene) {
  const auto order = tree.order();
  std::vector<std::vector<std::size_t>> groups(n);
  for (std::size_t i = 0; i < order.size(); ++i) {
    std::size_t at = i;
    while (at >= n) at = static_cast<std::size_t>(order[at].parent);
    groups[at].push_back(static_cast<std::size_t>(order[i].light));
  }
  double cost = 0;
  for (const auto& group : groups) cost += cost_of_one_for_all(scene, group);
  return cost;
}

void expect_costs_by_brute_force(const PersistentTree& tree, const Scene& scene) {
  const auto costs = tree.costs();
  ASSERT_EQ(costs.size(), scene.directions.size());
  EXPECT_EQ(costs[0], 0);
  const double power = std::accumulate(scene.powers.begin(), scene.powers.end(), 0.0);
  double left_out = 0;
  for (std::size_t n = costs.size(); n > 0; --n) {
    // the forms are differences of terms of about 10 · power²
    EXPECT_NEAR(left_out, cost_of_the_first(n, tree, scene), 1e-12 * power * power) << "the first " << n;
    left_out += costs[n - 1];
  }
}

TEST(PersistentTree, CostsAreWhatTheLightsThatAreLeftOutAddToTheError) {
  for (const int n : {1, 2, 3, 17, 64}) {
    SCOPED_TRACE(n);
    Scene scene(n, 40 + static_cast<unsigned>(n));
    PersistentTree tree(n);
    tree.build(scene.lights());
    expect_costs_by_brute_force(tree, scene);
    std::mt19937 random(7);
    const auto places = random_directions(50, 9, true);
    for (std::size_t frame = 0; frame < places.size(); ++frame) {
      const int light = static_cast<int>(random() % static_cast<unsigned>(n));
      scene.directions[static_cast<std::size_t>(light)] = places[frame];
      scene.place(light);
      // some fade, some go out, some come back
      for (double& power : scene.powers) power *= random() % 9 == 0 ? 0 : 0.9;
      scene.powers[random() % static_cast<unsigned>(n)] += 0.1;
      tree.follow(scene.lights(), std::array{light});
      if (frame % 10 == 9) expect_costs_by_brute_force(tree, scene);
    }
  }
}

TEST(PersistentTree, FirstJoinsThePairThatCostsLeast) {
  const Scene scene(30, 10);
  PersistentTree tree(30);
  tree.build(scene.lights());
  const auto order = tree.order();
  const auto cost = [&](std::size_t a, std::size_t b) {
    const double w = scene.powers[a] + scene.powers[b];
    if (!(w > 0)) return 0.0;
    const Vec3d m =
        (scene.powers[a] * scene.directions[a] + scene.powers[b] * scene.directions[b]).normalized();
    const double own =
        w * w * error_kernel(m, m) +
        scene.powers[a] * scene.powers[a] * error_kernel(scene.directions[a], scene.directions[a]) +
        scene.powers[b] * scene.powers[b] * error_kernel(scene.directions[b], scene.directions[b]);
    return own / 2 -
           w * (scene.powers[a] * error_kernel(m, scene.directions[a]) +
                scene.powers[b] * error_kernel(m, scene.directions[b])) +
           scene.powers[a] * scene.powers[b] * error_kernel(scene.directions[a], scene.directions[b]);
  };
  double least = 1e9;
  for (std::size_t a = 0; a < 30; ++a)
    for (std::size_t b = 0; b < a; ++b) least = std::min(least, cost(a, b));
  const auto last = static_cast<std::size_t>(order.back().light);
  const auto parent = static_cast<std::size_t>(order[static_cast<std::size_t>(order.back().parent)].light);
  EXPECT_NEAR(cost(last, parent), least, 1e-12);
}

}  // namespace
}  // namespace lightwell::test
