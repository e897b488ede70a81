// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/placement_kernel/kernel.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "lighting/decomposition/atoms.h"
#include "lighting/decomposition/error_kernel.h"
#include "tests/support/directions.h"

namespace lightwell::test {
namespace {

using placement_kernel::Kernels;

std::vector<const Kernels*> all_kernels() {
  std::vector<const Kernels*> all = {&placement_kernel::kPortableKernels};
  if (placement_kernel::avx2_kernels()) all.push_back(placement_kernel::avx2_kernels());
  return all;
}

Atoms random_atoms(int count, unsigned seed) {
  Atoms atoms(count);
  const auto d = random_directions(count, seed, true);
  const auto w = random_powers(count, seed + 1), v = random_powers(count, seed + 2);
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    atoms.add(d[k], {w[k], v[k], (w[k] + v[k]) / 2}, 0.01);
  }
  atoms.finish();
  return atoms;
}

// The kernel without the moments' part.
double shadow_part(const Vec3d& a, const Vec3d& b) {
  return error_kernel(a, b) - moment_weight() * lambertian_moments(a).dot(lambertian_moments(b));
}

TEST(PlacementKernels, PotentialsAreTheSumsOverPairs) {
  const Atoms atoms = random_atoms(1003, 1), places = random_atoms(13, 5);
  auto at = places.points();
  at.count = places.count;
  for (const Kernels* kernels : all_kernels()) {
    std::array<std::vector<double>, 3> rgb;
    for (auto& row : rgb) row.assign(16, -1);
    std::vector<double> one(16, -1);
    double* const rows[3] = {rgb[0].data(), rgb[1].data(), rgb[2].data()};
    kernels->potentials(atoms.points(), atoms.weights().data(), kernel_shares(), at, rows);
    kernels->potential(atoms.points(), atoms.luminance.data(), kernel_shares(), at, one.data());
    for (int i = 0; i < 13; ++i) {
      Rgbd sum = Rgbd::Zero();
      for (int k = 0; k < atoms.count; ++k)
        sum += shadow_part(places.direction(i), atoms.direction(k)) * atoms.weight_of(k);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(rgb[static_cast<std::size_t>(c)][static_cast<std::size_t>(i)], sum[c],
                    3e-6);  // floats of sum 3
      EXPECT_NEAR(one[static_cast<std::size_t>(i)], luminance(sum), 3e-6);
    }
    EXPECT_EQ(one[13], -1);  // places behind the count are left alone
  }
}

TEST(PlacementKernels, GradientIsTheDifferenceQuotientOfThePotential) {
  const Atoms atoms = random_atoms(400, 8);
  const auto potential = [&](const Vec3d& d) {
    double sum = 0;
    for (int k = 0; k < atoms.count; ++k)
      sum += shadow_part(d, atoms.direction(k)) *
             static_cast<double>(atoms.luminance[static_cast<std::size_t>(k)]);
    return sum;
  };
  const Atoms places = random_atoms(9, 15);
  auto at = places.points();
  at.count = 9;
  for (const Kernels* kernels : all_kernels()) {
    std::vector<double> out(36);
    kernels->gradient(atoms.points(), atoms.luminance.data(), kernel_shares(), at, out.data());
    for (int i = 0; i < 9; ++i) {
      const Vec3d d = places.direction(i);
      Vec3d slope(out[4 * static_cast<std::size_t>(i)], out[4 * static_cast<std::size_t>(i) + 1],
                  out[4 * static_cast<std::size_t>(i) + 2]);
      slope.y() += kGroundShare * ground_share_slope(d.y()) * out[4 * static_cast<std::size_t>(i) + 3];
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3d across = (Vec3d::Unit(axis) - d[axis] * d).eval();
        const double quotient =
            (potential((d + 1e-5 * across).normalized()) - potential((d - 1e-5 * across).normalized())) /
            2e-5;
        EXPECT_NEAR(slope.dot(across), quotient, 2e-4);  // floats, near atoms
      }
    }
  }
}

TEST(PlacementKernels, NearestIsTheNearest) {
  const Atoms atoms = random_atoms(500, 21), places = random_atoms(37, 25);
  auto at = places.points();
  at.count = 37;
  for (const Kernels* kernels : all_kernels()) {
    std::vector<int> index(atoms.x.size());
    std::vector<float> distance(atoms.x.size());
    kernels->nearest(atoms.points(), at, index.data(), distance.data());
    for (int k = 0; k < atoms.count; ++k) {
      double least = 9;
      for (int i = 0; i < 37; ++i) least = std::min(least, (places.direction(i) - atoms.direction(k)).norm());
      const auto j = static_cast<std::size_t>(k);
      EXPECT_NEAR(static_cast<double>(distance[j]), least, 1e-6);
      EXPECT_NEAR((places.direction(index[j]) - atoms.direction(k)).norm(), least, 1e-6);
    }
  }
}

TEST(PlacementKernels, MomentsAreTheSumsOfTheDoubles) {
  const Atoms atoms = random_atoms(700, 31);
  MomentMatrix expected = MomentMatrix::Zero();
  for (int k = 0; k < atoms.count; ++k)
    expected += lambertian_moments(atoms.direction(k)) * atoms.weight_of(k).matrix().transpose();
  for (const Kernels* kernels : all_kernels()) {
    MomentMatrix sums = MomentMatrix::Zero();
    kernels->add_moments(atoms.points(), atoms.weights().data(), sums.data());
    EXPECT_LT((sums - expected).cwiseAbs().maxCoeff(), 1e-6);  // floats of sum 1
  }
}

TEST(PlacementKernels, MatricesOfAnySize) {
  for (const int n : {1, 3, 4, 7, 12, 37, 64}) {
    const int stride = (n + 3) / 4 * 4;
    const auto at = [&](int i, int j) { return static_cast<std::size_t>(i * stride + j); };
    std::vector<double> m(static_cast<std::size_t>(stride * stride), 0),
        left(static_cast<std::size_t>(5 * stride), 0), v(static_cast<std::size_t>(stride), 0);
    for (int i = 0; i < n; ++i) {
      v[static_cast<std::size_t>(i)] = std::sin(i + 1.0);
      for (int j = 0; j < n; ++j) m[at(i, j)] = std::cos(i * j + i + j);
      for (int r = 0; r < 5; ++r) left[at(r, i)] = std::sin(r * 3.0 + i);
    }
    for (const Kernels* kernels : all_kernels()) {
      std::vector<double> out(static_cast<std::size_t>(stride), 0),
          rows(static_cast<std::size_t>(5 * stride), 0), outer = m;
      kernels->multiply(m.data(), n, stride, v.data(), out.data());
      kernels->multiply_rows(left.data(), 5, m.data(), stride, rows.data());
      kernels->add_outer(outer.data(), n, stride, 0.5, v.data(), v.data());
      for (int i = 0; i < n; ++i) {
        double expected = 0;
        for (int j = 0; j < n; ++j) expected += m[at(i, j)] * v[static_cast<std::size_t>(j)];
        EXPECT_NEAR(out[static_cast<std::size_t>(i)], expected, 1e-12);
        for (int r = 0; r < 5; ++r) {
          double product = 0;
          for (int j = 0; j < n; ++j) product += left[at(r, j)] * m[at(j, i)];
          EXPECT_NEAR(rows[at(r, i)], product, 1e-12);
        }
        for (int j = 0; j < n; ++j)
          EXPECT_NEAR(outer[at(i, j)],
                      m[at(i, j)] + 0.5 * v[static_cast<std::size_t>(i)] * v[static_cast<std::size_t>(j)],
                      1e-14);
      }
    }
  }
}

// Columns of a place's exchange with each light; rows are padded to fours by lights that are 0 and priceless.
struct Exchange {
  std::vector<double> by_inverse, step, inverse_pivot, price;
  double residual = 0.3, complement = 0.7;
  Exchange(int lights, unsigned seed) {
    const auto padded = static_cast<std::size_t>((lights + 3) / 4 * 4);
    for (auto* column : {&by_inverse, &step, &inverse_pivot, &price}) column->assign(padded, 0);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (std::size_t i = 0; i < padded; ++i) {
      price[i] = std::numeric_limits<double>::infinity();
      if (i >= static_cast<std::size_t>(lights)) continue;
      by_inverse[i] = uniform(random);
      step[i] = uniform(random);
      inverse_pivot[i] = 0.1 + std::abs(uniform(random));
      price[i] = 0.1 * std::abs(uniform(random));
    }
  }
  [[nodiscard]] double net(std::size_t i) const {
    const double h = by_inverse[i];
    const double r = residual + h * step[i];
    return r > 0 ? r * r / (complement + h * h * inverse_pivot[i]) - price[i]
                 : -std::numeric_limits<double>::infinity();
  }
  int best(const Kernels& kernels, double* least) const {
    return kernels.best_to_leave(by_inverse.data(), step.data(), inverse_pivot.data(), price.data(),
                                 static_cast<int>(price.size()), residual, complement, least);
  }
};

TEST(PlacementKernels, BestToLeavePaysMost) {
  for (const Kernels* kernels : all_kernels())
    for (const int lights : {1, 2, 3, 4, 5, 7, 8, 17, 64, 127})
      for (unsigned seed = 0; seed < 20; ++seed) {
        const Exchange exchange(lights, seed);
        double most = -1, least = most;
        int expected = -1;
        for (int i = 0; i < lights; ++i) {
          const double net = exchange.net(static_cast<std::size_t>(i));
          if (net <= most) continue;
          most = net;
          expected = i;
        }
        EXPECT_EQ(exchange.best(*kernels, &least), expected) << lights << " " << seed;
        EXPECT_NEAR(least, most, 1e-14);  // fused products round once less
      }
}

TEST(PlacementKernels, NobodyLeavesWhereNobodyPays) {
  for (const Kernels* kernels : all_kernels()) {
    Exchange exchange(13, 3);
    double most = 0;
    for (std::size_t i = 0; i < 13; ++i) most = std::max(most, exchange.net(i));
    double least = most + 1e-12;
    EXPECT_EQ(exchange.best(*kernels, &least), -1);  // not above what must be reached
    EXPECT_EQ(least, most + 1e-12);
    exchange.residual = -2;  // |h t| < 1: from each the place would take light
    least = 0;
    EXPECT_EQ(exchange.best(*kernels, &least), -1);
    EXPECT_EQ(least, 0);
    exchange.residual = 0.3;
    exchange.price.assign(16, std::numeric_limits<double>::infinity());  // all have just come
    EXPECT_EQ(exchange.best(*kernels, &least), -1);
    EXPECT_EQ(least, 0);
  }
}

// Which of equals leaves may not hang on the machine: the first.
TEST(PlacementKernels, OfEqualsTheFirstLeaves) {
  for (const Kernels* kernels : all_kernels())
    for (int first = 0; first < 16; ++first)
      for (int second = first + 1; second < 16; ++second) {
        Exchange exchange(16, 5);
        double most = 0;
        for (std::size_t i = 0; i < 16; ++i) most = std::max(most, exchange.net(i));
        for (const auto i : {static_cast<std::size_t>(first), static_cast<std::size_t>(second)}) {
          exchange.by_inverse[i] = 0.5;  // halves and quarters: no rounding on any machine
          exchange.step[i] = 0.5;
          exchange.inverse_pivot[i] = 1;
          exchange.price[i] = -4;
        }
        exchange.residual = 0.25;
        exchange.complement = 0.75;
        double least = most;
        EXPECT_EQ(exchange.best(*kernels, &least), first) << second;
        EXPECT_EQ(least, 4.25);
      }
}

TEST(PlacementKernels, RingsCountWhatIsNotLightAsNone) {
  constexpr int n = 21;
  std::vector<float> radiance(n, 2), omega(n, 0.5f);
  radiance[3] = -1;
  radiance[9] = std::numeric_limits<float>::quiet_NaN();
  radiance[17] = std::numeric_limits<float>::infinity();
  radiance[20] = -std::numeric_limits<float>::infinity();
  for (const Kernels* kernels : all_kernels()) {
    std::vector<float> sums[5];
    for (auto& s : sums) s.assign(n, 1);
    kernels->add_ring({radiance.data(), radiance.data(), radiance.data(), omega.data()}, n, 0.6f, 0.8f,
                      {sums[0].data(), sums[1].data(), sums[2].data(), sums[3].data(), sums[4].data()});
    for (std::size_t k = 0; k < n; ++k) {
      const bool dark = k == 3 || k == 9 || k == 17 || k == 20;
      EXPECT_FLOAT_EQ(sums[0][k], dark ? 1 : 2) << k;
      EXPECT_FLOAT_EQ(sums[3][k], dark ? 1 : 1.6f) << k;
      EXPECT_FLOAT_EQ(sums[4][k], dark ? 1 : 1.8f) << k;
    }
  }
}

}  // namespace
}  // namespace lightwell::test
