// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/ray_kriging.h"

#include <gtest/gtest.h>

#include <random>

#include "lighting/field/live_kernel/kernel.h"
#include "lighting/field/live_sums.h"
#include "tests/support/analytic_fields.h"

namespace lightwell {
namespace {

Eigen::MatrixXd random_places(int dimensions, int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> along(-2, 2);
  return Eigen::MatrixXd::NullaryExpr(dimensions, count, [&] { return along(random); });
}

TEST(Kriging, IsExactAtThePlacesAndSumsToOneEverywhere) {
  const Eigen::MatrixXd places = random_places(2, 10);
  const Kriging kriging(places);
  for (Eigen::Index n = 0; n < places.cols(); ++n) {
    const Eigen::VectorXd weights = kriging.weights(places.col(n));
    // The nugget, 1e-4 of the spread, is all that it may stay away from a value.
    EXPECT_NEAR(weights[n], 1, 2e-3);
    EXPECT_NEAR(weights.sum(), 1, 1e-9);
  }
  EXPECT_NEAR(kriging.weights(Vec2d(30, -4)).sum(), 1, 1e-7);
}

// However far from the others one place is, and however far apart two groups are: of a spread that is set by them, the nugget
// would take .03 to .14.
TEST(Kriging, IsExactWithOutliers) {
  for (const double away : {10.0, 100.0, 3000.0})
    for (const Eigen::Index moved : {1, 5}) {
      Eigen::MatrixXd places = random_places(2, 10);
      places.leftCols(moved).colwise() += Vec2d(away, -away);
      const Kriging kriging(places);
      for (Eigen::Index n = 0; n < places.cols(); ++n)
        EXPECT_NEAR(kriging.weights(places.col(n))[n], 1, 2e-3) << away << " " << moved << " " << n;
    }
}

TEST(Kriging, OnePlaceGivesItsValueEverywhere) {
  const Kriging kriging(Eigen::MatrixXd::Constant(3, 1, 5.0));
  EXPECT_NEAR(kriging.weights(Vec3d(-7, 2, 1))[0], 1, 1e-12);
}

TEST(Kriging, PlacesOnALineSayNothingAcrossIt) {
  Eigen::MatrixXd places(2, 4);
  places << 0, 1, 2, 4, 0, 0, 0, 0;
  const Kriging kriging(places);
  const Eigen::VectorXd above = kriging.weights(Vec2d(1.5, 0.8)), below = kriging.weights(Vec2d(1.5, -0.8));
  EXPECT_LT((above - below).norm(), 1e-12);
}

TEST(Kriging, PlacesThatCoincideShareTheirWeight) {
  Eigen::MatrixXd places(2, 3);
  places << 0, 0, 1, 0, 0, 1;
  const Eigen::VectorXd weights = Kriging(places).weights(Vec2d(0, 0));
  EXPECT_NEAR(weights[0], weights[1], 1e-9);
  EXPECT_NEAR(weights[0] + weights[1], 1, 1e-3);
}

TEST(Kriging, AnAbsentValueBecomesWhatTheOthersForetellForItsPlace) {
  const Eigen::MatrixXd places = random_places(2, 10);
  const Kriging kriging(places);
  const Eigen::VectorXd linear = places.transpose() * Vec2d(0.5, -0.2) + Eigen::VectorXd::Constant(10, 3);
  Eigen::VectorXd values = linear, weights = Eigen::VectorXd::Ones(10);
  for (const Eigen::Index absent : {3, 6}) {
    values[absent] = 1e6;  // nothing that it said counts
    weights[absent] = 0;
  }
  const Eigen::VectorXd completed = kriging.completion(weights) * values;
  EXPECT_EQ(completed[0], values[0]);
  // Exact but for the prior of the slope, and for those outside of all others.
  EXPECT_NEAR(completed[3], linear[3], 0.1);
  EXPECT_NEAR(completed[6], linear[6], 0.1);
}

TEST(Kriging, AValueFadesEvenlyFromMeasuredToForetold) {
  const Kriging kriging(random_places(2, 6));
  const Eigen::VectorXd values =
      Eigen::VectorXd::LinSpaced(6, 1, 2).cwiseProduct(Eigen::VectorXd::LinSpaced(6, 3, -1));
  const auto at = [&](double weight) {
    Eigen::VectorXd weights = Eigen::VectorXd::Ones(6);
    weights[2] = weight;
    return (kriging.completion(weights) * values)[2];
  };
  EXPECT_EQ(at(1), values[2]);
  EXPECT_NEAR(at(1 - 1e-6), at(1), 1e-5);
  EXPECT_NEAR(at(1e-6), at(0), 1e-5);
  EXPECT_NEAR(at(0.5), (at(0) + at(1)) / 2, 1e-9);
}

TEST(Kriging, ValuesThatFadeTogetherKeepTheirMix) {
  const Kriging kriging(random_places(2, 6));
  Eigen::VectorXd weights(6);
  weights << 1, 0.5, 1, 0, 0.2, 1;
  EXPECT_LT((kriging.completion(1e-3 * weights) - kriging.completion(weights)).norm(), 1e-12);
  EXPECT_TRUE(kriging.completion(Eigen::VectorXd::Constant(6, 0.1)).isIdentity());
}

TEST(Kriging, WhereNothingCountsAllStays) {
  const Kriging kriging(random_places(2, 4));
  EXPECT_TRUE(kriging.completion(Eigen::VectorXd::Zero(4)).isIdentity());
  EXPECT_TRUE(Kriging(random_places(2, 1)).completion(Eigen::VectorXd::Constant(1, 0.3)).isIdentity(1e-12));
}

// Against the sums of a whole build, which look up the same planes.
TEST(LiveSums, AddUpAsThoseOfABuildDo) {
  const FieldGrid grid{{9, 5, 7}, {-1, 0, -2}, {1, 2, 2.5}};  // nothing a multiple of a register
  const std::vector<Vec3d> positions = {{0, 1, 0}, {-0.5, 0.2, 2}, {0.9, 1.9, -1}};
  const SpherePartition sphere(150);
  std::vector<RayKriging> rays;
  Eigen::MatrixXd y(25, sphere.cells());
  for (int cell = 0; cell < sphere.cells(); ++cell) {
    rays.emplace_back(grid, sphere.centre(cell), positions);
    harmonics(sphere.centre(cell), 4, y.col(cell).data());
  }
  std::mt19937 random(3);
  std::uniform_real_distribution<float> light(0, 5);
  std::vector<float> radiance(static_cast<std::size_t>(sphere.cells()) * 9);
  for (float& value : radiance) value = light(random);
  LightField field;
  field.grid = grid;
  field.radiance.assign(grid.points() * 75, 0.0f);
  LiveSums(grid, 4, rays, y).add(radiance, field);

  FieldSums reference(grid, 4);
  for (std::size_t d = 0; d < rays.size(); ++d) {
    std::vector<FieldDirection> batch(
        1, {rays[d].plane, {}, y.col(static_cast<Eigen::Index>(d)).cast<float>(), 0});
    PlaneImage& image = batch[0].image;
    image.resize(rays[d].plane.width(), rays[d].plane.height());
    for (int c = 0; c < 3; ++c)
      for (std::size_t p = 0; p < image.pixels(); ++p) {
        float sum = 0;
        for (std::size_t n = 0; n < 3; ++n)
          sum += rays[d].weights(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(n)) *
                 radiance[(3 * d + static_cast<std::size_t>(c)) * 3 + n];
        image.channel(c)[p] = std::max(sum, 0.0f);
      }
    for (int z = 0; z < reference.slabs(); ++z) reference.add(batch, z);
  }
  const LightField expected = std::move(reference).take();
  // Sums of 150 products of about 5, in another order.
  for (std::size_t i = 0; i < field.radiance.size(); ++i)
    ASSERT_NEAR(field.radiance[i], expected.radiance[i], 2e-3);
}

TEST(LiveKernel, FastestMachinesAgreeWithAllOthers) {
  const live_kernel::Kernels* fast = live_kernel::avx2_kernels();
  if (fast == nullptr) GTEST_SKIP() << "this processor has no AVX2 with FMA";
  constexpr int kPoints = 56, kStride = 64, kDirections = 37, kCount = 27;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> value(-1, 1);
  std::vector<float> radiance(kStride * kDirections), y(kDirections * kCount);
  for (float& v : radiance) v = value(random);
  for (float& v : y) v = value(random);
  std::vector<float> a(kPoints * kCount, 1.0f), b = a;
  live_kernel::kPortableKernels.project(radiance.data(), kStride, kDirections, y.data(), kCount, kPoints,
                                        a.data());
  fast->project(radiance.data(), kStride, kDirections, y.data(), kCount, kPoints, b.data());
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1e-5);
  std::vector<float> c(kPoints), d(kPoints);
  live_kernel::kPortableKernels.interpolate(radiance.data(), kPoints, 11, y.data(), c.data());
  fast->interpolate(radiance.data(), kPoints, 11, y.data(), d.data());
  for (std::size_t i = 0; i < c.size(); ++i) {
    ASSERT_NEAR(c[i], d[i], 1e-5);
    ASSERT_GE(c[i], 0);
  }
}

}  // namespace
}  // namespace lightwell
