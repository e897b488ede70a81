// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/light_powers.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <vector>

#include "lighting/decomposition/light_exchange.h"
#include "tests/support/directions.h"

namespace lightwell::test {
namespace {

Eigen::MatrixXd matrix_of(const std::vector<Vec3d>& d) {
  const auto n = static_cast<Eigen::Index>(d.size());
  Eigen::MatrixXd g(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      g(i, j) = error_kernel(d[static_cast<std::size_t>(i)], d[static_cast<std::size_t>(j)]) +
                (i == j ? kRidge : 0);
  return g;
}

// What light at the given places is worth at each light.
std::vector<double> seen_by(const std::vector<Vec3d>& lights, const std::vector<Vec3d>& map,
                            const std::vector<double>& power, int stride) {
  std::vector<double> b(static_cast<std::size_t>(stride), 0);
  for (std::size_t i = 0; i < lights.size(); ++i)
    for (std::size_t k = 0; k < map.size(); ++k) b[i] += power[k] * error_kernel(lights[i], map[k]);
  return b;
}

double cost(const Eigen::MatrixXd& g, const Eigen::VectorXd& b, const Eigen::VectorXd& w) {
  return 0.5 * w.dot(g * w) - w.dot(b);
}

TEST(LightPowers, RecoverPowersThatTheLightsCanShow) {
  for (const int n : {1, 2, 17, 40}) {
    const auto d = random_directions(n, 3);
    const auto truth = random_powers(n, 4);
    LightPowers powers(n);
    powers.place(d);
    auto dark = powers.no_dark();
    std::vector<double> w(static_cast<std::size_t>(powers.stride()));
    powers.solve(seen_by(d, d, truth, powers.stride()), dark, w);
    for (std::size_t i = 0; i < d.size(); ++i)
      EXPECT_NEAR(w[i], truth[i], 1e-6);  // the ridge over the least eigenvalue
  }
}

TEST(LightPowers, AreFeasibleAndNoFeasibleNeighbourIsBetter) {
  const int n = 60;
  const auto lights = random_directions(n, 5),
             map = random_directions(500, 6, true);  // below there is no light
  const auto power = random_powers(500, 7);
  LightPowers powers(n);
  powers.place(lights);
  auto dark = powers.no_dark();
  std::vector<double> w(static_cast<std::size_t>(powers.stride()));
  const auto b = seen_by(lights, map, power, powers.stride());
  powers.solve(b, dark, w);
  const Eigen::MatrixXd g = matrix_of(lights);
  const Eigen::VectorXd bv = Eigen::VectorXd::Map(b.data(), n);
  const Eigen::VectorXd wv = Eigen::VectorXd::Map(w.data(), n);
  EXPECT_EQ(wv.minCoeff(), 0);
  EXPECT_FALSE(dark.lights.empty());
  const double least = cost(g, bv, wv);
  for (int i = 0; i < n; ++i)
    for (const double step : {1e-4, -1e-4}) {
      Eigen::VectorXd moved = wv;
      moved[i] = std::max(0.0, moved[i] + step);
      EXPECT_GE(cost(g, bv, moved), least - 1e-12);
    }
}

TEST(LightPowers, InverseHoldsHoweverOftenLightsMove) {
  const int n = 37;
  auto d = random_directions(n, 8);
  const auto places = random_directions(400, 9);
  LightPowers powers(n);
  powers.place(d);
  for (std::size_t k = 0; k < places.size(); ++k) {
    d[k % n] = places[k];
    ASSERT_TRUE(powers.move(static_cast<int>(k % n), d));
  }
  const Eigen::MatrixXd g = matrix_of(d);
  double off = 0;
  for (int i = 0; i < n; ++i) {
    Eigen::VectorXd column(n);
    for (int j = 0; j < n; ++j) column[j] = powers.inverse()[j * powers.stride() + i];
    off = std::max(off, (g * column - Eigen::VectorXd::Unit(n, i)).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(off, 1e-4);  // measured 1e-6; uncorrected updates end in not-a-number after a dozen moves
}

TEST(LightExchange, WorthIsWhatIsLostWithoutTheLight) {
  const int n = 20;
  const auto lights = random_directions(n, 11, true), map = random_directions(300, 12, true);
  LightPowers powers(n);
  powers.place(lights);
  auto dark = powers.no_dark();
  std::vector<double> w(static_cast<std::size_t>(powers.stride()));
  const auto b = seen_by(lights, map, random_powers(300, 13), powers.stride());
  powers.solve(b, dark, w);
  LightExchange exchange(n, 8);
  exchange.weigh(powers, w, dark);
  const Eigen::MatrixXd g = matrix_of(lights);
  const Eigen::VectorXd bv = Eigen::VectorXd::Map(b.data(), n);
  std::vector<Eigen::Index> lit;
  for (int i = 0; i < n; ++i)
    if (!dark.is_dark[static_cast<std::size_t>(i)]) lit.push_back(i);
  const auto least_cost = [&](const std::vector<Eigen::Index>& set) {
    const Eigen::VectorXd s = Eigen::MatrixXd(g(set, set)).llt().solve(Eigen::VectorXd(bv(set)));
    return -0.5 * s.dot(Eigen::VectorXd(bv(set)));
  };
  const double all = least_cost(lit);
  for (const Eigen::Index i : lit) {
    std::vector<Eigen::Index> without;
    for (const Eigen::Index j : lit)
      if (j != i) without.push_back(j);
    // worth is twice the quadratic form's loss
    EXPECT_NEAR(exchange.worth()[static_cast<std::size_t>(i)], 2 * (least_cost(without) - all), 1e-8);
  }
}

TEST(LightExchange, TakesThePairThatBruteForceFindsBest) {
  const int n = 12;
  const auto lights = random_directions(n, 21, true), map = random_directions(300, 22, true),
             places = random_directions(10, 23, true);
  const auto power = random_powers(300, 24);
  LightPowers powers(n);
  powers.place(lights);
  auto dark = powers.no_dark();
  std::vector<double> w(static_cast<std::size_t>(powers.stride()));
  const auto b = seen_by(lights, map, power, powers.stride());
  powers.solve(b, dark, w);
  LightExchange exchange(n, 10);
  exchange.weigh(powers, w, dark);
  const auto rest = seen_by(places, map, power, 12);
  LightExchange::Options options;
  options.hysteresis = 0;
  const auto pairs = exchange.choose(lights, w, places, rest, options);
  const auto free_cost = [&](const std::vector<Vec3d>& set) {  // powers of any sign, as the exchange reckons
    const auto bs = seen_by(set, map, power, static_cast<int>(set.size()));
    const Eigen::VectorXd v = Eigen::VectorXd::Map(bs.data(), static_cast<Eigen::Index>(set.size()));
    return -0.5 * v.dot(matrix_of(set).llt().solve(v));
  };
  std::vector<Vec3d> lit;
  std::vector<int> index;
  for (int i = 0; i < n; ++i)
    if (!dark.is_dark[static_cast<std::size_t>(i)])
      lit.push_back(lights[static_cast<std::size_t>(i)]), index.push_back(i);
  double best = free_cost(lit);
  const double before = best;
  for (std::size_t i = 0; i < lit.size(); ++i)
    for (const Vec3d& place : places) {
      auto tried = lit;
      tried[i] = place;
      best = std::min(best, free_cost(tried));
    }
  if (lit.size() < static_cast<std::size_t>(n))
    for (const Vec3d& place : places) {
      auto tried = lit;
      tried.push_back(place);  // in a dark light's stead
      best = std::min(best, free_cost(tried));
    }
  ASSERT_EQ(pairs.size(), 1u);
  auto chosen = lit;
  const auto& [light, place] = pairs.front();
  const auto at = std::find(index.begin(), index.end(), light);
  if (at == index.end())
    chosen.push_back(places[static_cast<std::size_t>(place)]);
  else
    chosen[static_cast<std::size_t>(at - index.begin())] = places[static_cast<std::size_t>(place)];
  EXPECT_LT(best, before - 1e-9);
  EXPECT_NEAR(free_cost(chosen), best, 1e-9);
}

}  // namespace
}  // namespace lightwell::test
