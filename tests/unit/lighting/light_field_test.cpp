// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/light_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lighting/field/direction_estimator.h"
#include "tests/support/analytic_fields.h"

namespace lightwell {
namespace {

FieldGrid cube(int side) {
  return {{side, side, side}, Vec3d::Zero(), Vec3d::Ones()};
}

// Sums over directions against the definition: each image interpolated at each grid point, in double.
TEST(FieldSums, AreTheSumsOverDirectionsAtEveryPoint) {
  const FieldGrid grid{{4, 5, 6}, Vec3d(-1, 0, 0), Vec3d(1, 1, 2)};
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<float> light(0, 3);
  std::vector<FieldDirection> batch;
  for (int d = 0; d < 12; ++d) {
    const Vec3d direction =
        d < 3 ? Vec3d(Vec3d::Unit(d)) : Vec3d(normal(random), normal(random), normal(random));
    batch.push_back({ShearPlane(grid, direction, 1 + d % 2), {}, Eigen::VectorXf(9), 0.05f});
    batch.back().image.resize(batch.back().plane.width(), batch.back().plane.height());
    for (float& value : batch.back().image.channels) value = light(random);
    for (float& value : batch.back().harmonics) value = light(random) - 1.5f;
  }
  FieldSums sums(grid, 2);
  for (int z = 0; z < sums.slabs(); ++z) sums.add(batch, z);
  const LightField field = std::move(sums).take();
  for (int k = 0; k < 6; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 4; ++i) {
        Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(9, 3);
        for (const FieldDirection& direction : batch) {
          const Vec2d at = direction.plane.pixel_of(Vec3d(i, j, k)).cwiseMax(0.0);
          const int x = static_cast<int>(at.x()), y = static_cast<int>(at.y());
          const double fx = at.x() - x, fy = at.y() - y;
          for (int c = 0; c < 3; ++c) {
            const auto pixel = [&](int px, int py) {
              return static_cast<double>(direction.image.channel(c)[py * direction.image.width + px]);
            };
            const double value = (1 - fy) * ((1 - fx) * pixel(x, y) + fx * pixel(x + 1, y)) +
                                 fy * ((1 - fx) * pixel(x, y + 1) + fx * pixel(x + 1, y + 1));
            expected.col(c) += direction.harmonics.cast<double>() * value;
          }
        }
        const LightAtPoint found = light_at(field, grid.position(i, j, k));
        EXPECT_LT((found.radiance.matrix() - expected).cwiseAbs().maxCoeff(), 1e-4);
      }
}

TEST(FieldSums, AreTheSameInWhateverOrderSlabsAreTaken) {
  const FieldGrid grid = cube(6);
  std::mt19937 random(2);
  std::uniform_real_distribution<float> light(0, 3);
  std::vector<FieldDirection> batch;
  for (int d = 0; d < 5; ++d) {
    batch.push_back(
        {ShearPlane(grid, Vec3d(d - 2, 1, 0.3 * d), 1), {}, Eigen::VectorXf::Constant(4, 0.1f), 0.1f});
    batch.back().image.resize(batch.back().plane.width(), batch.back().plane.height());
    for (float& value : batch.back().image.channels) value = light(random);
  }
  FieldSums up(grid, 1), down(grid, 1);
  for (int z = 0; z < 6; ++z) up.add(batch, z);
  for (int z = 6; z-- > 0;) down.add(batch, z);
  const LightField a = std::move(up).take(), b = std::move(down).take();
  EXPECT_EQ(a.radiance, b.radiance);
  EXPECT_EQ(a.confidence, b.confidence);
}

TEST(LightField, InterpolatesLinearlyBetweenPoints) {
  LightField field;
  field.grid = {{3, 4, 2}, Vec3d(0, 1, 2), Vec3d(4, 4, 3)};
  field.degree = 1;
  field.radiance.assign(field.grid.points() * 12, 0);
  field.confidence.assign(field.grid.points(), 0.5f);
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 3; ++i) {
        const Vec3d p = field.grid.position(i, j, k);
        field.plane(k, 2, 1)[j * 3 + i] = static_cast<float>(1 + p.x() - 2 * p.y() + 3 * p.z());
      }
  for (const Vec3d& p : {Vec3d(0, 1, 2), Vec3d(4, 4, 3), Vec3d(1.3, 2.7, 2.2)}) {
    const LightAtPoint light = light_at(field, p);
    EXPECT_NEAR(light.radiance(2, 1), 1 + p.x() - 2 * p.y() + 3 * p.z(), 1e-5);
    EXPECT_EQ(light.radiance(2, 0), 0);
    EXPECT_NEAR(light.confidence, 0.5, 1e-12);
  }
}

// One thousand probes of the 16³, in a smaller cube so that a test stays short: as many rays a cell.
class FieldOfProbes : public testing::Test {
 protected:
  const FieldGrid grid_ = cube(8);
  const std::vector<Vec3d> positions_ = test::random_positions(250, 1, 0.1);
  const DirectionBins bins_{LatLongProbe{}, 64, 32, 400, 4};
};

TEST_F(FieldOfProbes, ThatIsLinearIsKept) {
  const auto best = test::build_field(test::linear_field, grid_, positions_, bins_, 4, FieldMethod::best);
  EXPECT_LT(test::harmonics_error(best.field, test::linear_field, 20, 3000), 2e-3);
  EXPECT_LT(best.held_out_error, 1e-3);
}

// Enough directions that a lamp is several of them wide.
TEST_F(FieldOfProbes, InABoxOfLampsIsAtMostHalfAsWrongAsThePapersSplat) {
  const DirectionBins bins(LatLongProbe{}, 128, 64, 1500, 4);
  const auto best = test::build_field(test::box_of_lamps, grid_, positions_, bins, 4, FieldMethod::best);
  const auto low = test::build_field(test::box_of_lamps, grid_, positions_, bins, 4, FieldMethod::low);
  EXPECT_LT(test::harmonics_error(best.field, test::box_of_lamps, 20, 8000),
            0.5 * test::harmonics_error(low.field, test::box_of_lamps, 20, 8000));
}

TEST_F(FieldOfProbes, AtItsMiddleIsKnownAllAroundAndOutsideItsProbesIsNot) {
  const auto dense = test::build_field(test::linear_field, grid_, positions_, bins_, 1, FieldMethod::low);
  EXPECT_GT(light_at(dense.field, Vec3d::Constant(0.5)).confidence, 0.99);
  std::vector<Vec3d> corner = {Vec3d::Zero(), Vec3d(0.01, 0, 0)};
  const auto sparse = test::build_field(test::linear_field, grid_, corner, bins_, 1, FieldMethod::low);
  // 1.5 cells of 1/7 at a distance of √3: a disc of .0077 sr both ways, of 4π.
  EXPECT_LT(light_at(sparse.field, Vec3d::Ones()).confidence, 0.03);
  EXPECT_GT(light_at(sparse.field, Vec3d::Zero()).confidence, 0.95);
}

// Probes 10 cm wide in light that changes over a metre: rays taken from the centre would be wrong by a tenth of it.
TEST(MirrorBallField, RaysStartWhereTheyMetTheBall) {
  const MirrorBallProbe ball{0.1, std::nullopt, 2.1 * kPi / 180};
  const DirectionBins bins(ball, 100, 100, 400, 2);
  const auto positions = test::random_positions(250, 3, 0.1);
  const auto built = test::build_field(test::linear_field, cube(6), positions, bins, 2, FieldMethod::best);
  EXPECT_LT(test::harmonics_error(built.field, test::linear_field, 20, 3000), 4e-3);
}

// Irradiance from degree 4 against the cosine integral at the same point.
TEST(LightField, IrradianceOfDegreeFourIsWithinAPercentOfTheIntegral) {
  const Vec3d at(0.4, 0.3, 0.6);
  LightAtPoint light;
  light.radiance = test::exact_harmonics(test::box_of_lamps, at, 4, 20000).array();
  const SpherePartition sphere(20000), normals(60);
  double error = 0, norm = 0;
  for (int n = 0; n < normals.cells(); ++n) {
    const Vec3d normal = normals.centre(n);
    Rgbd exact = Rgbd::Zero();
    for (int i = 0; i < sphere.cells(); ++i) {
      const Vec3d d = sphere.centre(i);
      exact += sphere.cell_solid_angle_sr() * std::max(0.0, d.dot(normal)) * test::box_of_lamps(at, d);
    }
    error += (irradiance(light, normal) - exact).abs().sum();
    norm += exact.sum();
  }
  EXPECT_LT(error / norm, 0.01);
}

}  // namespace
}  // namespace lightwell
