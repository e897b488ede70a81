// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/lens_import/projections.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/support/expect_pixels.h"

namespace lightwell::calibration {
namespace {

using test::expect_pixels;

// Directions for the references below, and one more behind the image plane.
const std::vector<Vec3d> kDirections = {{0.1, -0.2, 1}, {0.5, 0.4, 1}, {-0.6, 0.3, 1}, {1.0, -0.7, 0.8}};

// mrcal 2.2: mrcal.project(directions, model, intrinsics), printed with nine decimals.
constexpr double kPrinted = 2e-9;

TEST(SourceProjection, IsMrcalsOwn) {
  const PinholePlane plane{{2000, 2010}, {1500, 1000}};
  const std::array<double, 12> k = {0.11, -0.05, 0.002, -0.003,  0.01,   0.2,
                                    0.03, 0.004, 0.001, -0.0005, 0.0007, 0.0003};
  const auto first = [&](std::size_t n) {
    PlaneDistortion out{};
    std::copy_n(k.begin(), n, out.begin());
    return out;
  };
  expect_pixels(stereographic(plane), kDirections,
                {{1697.560612768, 602.903168337},
                 {2414.313213189, 1735.107823404},
                 {411.149557977, 1547.147347116},
                 {3270.340810557, -245.434760227}},
                kPrinted);
  expect_pixels(
      perspective(plane, first(4)), kDirections,
      {{1700.495000000, 596.603050000}, {2532.835000000, 1834.025380000}, {244.290000000, 1631.446525000}},
      kPrinted);
  expect_pixels(
      perspective(plane, first(5)), kDirections,
      {{1700.495250000, 596.602547500}, {2533.524210000, 1834.579504840}, {243.196500000, 1631.996008750}},
      kPrinted);
  expect_pixels(
      perspective(plane, first(8)), kDirections,
      {{1698.489525001, 600.634054748}, {2450.215585443, 1767.599370696}, {352.997016096, 1576.821249412}},
      kPrinted);
  expect_pixels(
      perspective(plane, first(12)), kDirections,
      {{1698.587025001, 600.705912248}, {2450.867485443, 1768.277604996}, {353.694516096, 1577.576506912}},
      kPrinted);
  expect_pixels(
      cahvor(plane, {0.02, -0.03, 0.01, 0.05, -0.02}), kDirections,
      {{1701.886665395, 593.971011555}, {2526.204383256, 1827.593088207}, {263.118453918, 1622.729465082}},
      kPrinted);
}

TEST(SourceProjection, IsMrcalsSplinedOne) {
  SplinedStereographic model;
  model.plane = {{600, 610}, {500, 400}};
  model.nx = 6;
  model.ny = 5;
  model.fov_x_deg = 170;
  model.control = {0.0069,  0.0164,  0.0066,  -0.0261, 0.0181,  0.0089,  -0.0107, 0.0116,  0.0073,  0.0059,
                   0.0006,  0.0109,  -0.0147, -0.0033, -0.0096, 0.012,   0.0008,  -0.0058, -0.0156, -0.0051,
                   0.0002,  -0.0055, 0.0259,  0.0201,  -0.0542, -0.0378, -0.0035, -0.0084, 0.0043,  0.0043,
                   0.0424,  -0.0222, -0.0076, 0.0409,  0.0129,  0.0133,  -0.0103, -0.033,  0.0033,  0.0022,
                   -0.0245, -0.0137, -0.0014, -0.0189, -0.002,  0.0019,  0.0007,  -0.0101, 0.0119,  0.0178,
                   0.0064,  -0.0164, 0.0146,  -0.01,   0.0176,  -0.0214, 0.0183,  -0.0004, -0.025,  -0.0063};
  model.order = 2;
  expect_pixels(splined_stereographic(model), kDirections,
                {{569.005229654, 273.392020463},
                 {784.324339373, 615.244420348},
                 {172.350268145, 563.773036392},
                 {1031.777963567, 21.538127670}},
                kPrinted);
  model.order = 3;
  expect_pixels(splined_stereographic(model), kDirections,
                {{566.591263358, 274.339547532},
                 {782.403011617, 616.400238992},
                 {174.285903205, 562.610275715},
                 {1035.222645377, 20.110341143}},
                kPrinted);
}

TEST(SourceProjection, IsOpenCvsOwn) {
  // OpenCV 5.0: cv2.fisheye.projectPoints and cv2.omnidir.projectPoints, no rotation, no translation.
  const std::vector<Vec3d> directions = {
      {0.1, -0.2, 1}, {0.5, 0.4, 1}, {-0.6, 0.3, 1}, {1.0, -0.7, 0.4}, {3, 2, 0.1}};
  const PinholePlane plane{{285.5, 286.5}, {421.25, 398.75}};
  expect_pixels(equidistant(plane, {-0.0031, 0.0412, -0.0384, 0.0067}), directions,
                {{449.33632609437115, 342.38059596471226},
                 {548.486721181455, 500.8959071621348},
                 {270.00246391612245, 474.6386498914727},
                 {711.2463215077646, 195.04155068867885},
                 {759.6485640968486, 625.1392320227604}},
                1e-9);
  expect_pixels(omnidirectional(plane, 1.4, {-0.1, 0.02, 0.001, -0.002}), directions,
                {{432.9583557780291, 375.24401790029907},
                 {474.5031479948745, 441.54482477561544},
                 {357.7567153491844, 430.60783897103096},
                 {546.8688383401237, 310.47348271824893},
                 {579.6779262686885, 505.0662618614758}},
                1e-9);
}

// The inverses that their papers give, which the code does not use.
Vec3d double_sphere_ray(double xi, double alpha, const Vec2d& m) {
  const double r2 = m.squaredNorm();
  const double mz = (1 - alpha * alpha * r2) / (alpha * std::sqrt(1 - (2 * alpha - 1) * r2) + 1 - alpha);
  const double s = (mz * xi + std::sqrt(mz * mz + (1 - xi * xi) * r2)) / (mz * mz + r2);
  return {s * m.x(), s * m.y(), s * mz - xi};
}

Vec3d enhanced_unified_ray(double alpha, double beta, const Vec2d& m) {
  const double r2 = m.squaredNorm();
  const double mz =
      (1 - beta * alpha * alpha * r2) / (alpha * std::sqrt(1 - (2 * alpha - 1) * beta * r2) + 1 - alpha);
  return {m.x(), m.y(), mz};
}

TEST(SourceProjection, UndoesTheInversesOfTheUnifiedModels) {
  const PinholePlane plane{{158.3, 158.2}, {255, 257}};
  const auto ds = double_sphere(plane, -0.172, 0.593);
  const auto eucm = enhanced_unified(plane, 0.6, 1.1);
  std::size_t behind = 0;
  for (const Vec2d& m :
       {Vec2d(0, 0), Vec2d(0.3, -0.2), Vec2d(-1.1, 0.5), Vec2d(1.0, 1.2), Vec2d(-1.45, -1.4)}) {
    const Vec2d pixel = plane.focal.cwiseProduct(m) + plane.center;
    const Vec3d ray = double_sphere_ray(-0.172, 0.593, m);
    behind += ray.z() < 0;
    ASSERT_TRUE(ds(3 * ray));
    EXPECT_LT((*ds(3 * ray) - pixel).norm(), 1e-9);  // rounding, at hundreds of pixels
    const Vec3d other = enhanced_unified_ray(0.6, 1.1, m);
    ASSERT_TRUE(eucm(3 * other));
    EXPECT_LT((*eucm(3 * other) - pixel).norm(), 1e-9);
  }
  EXPECT_GT(behind, 0u);
  EXPECT_FALSE(ds({0, 0, -1}));
  EXPECT_FALSE(eucm({0, 0, -1}));
}

TEST(SourceProjection, StereographicIsASpecialCaseOfAllUnifiedModels) {
  const PinholePlane plane{{200, 201}, {320, 240}};
  const PinholePlane half{2 * plane.focal, plane.center};
  for (const Vec3d& d : {Vec3d(0.3, -0.8, 1), Vec3d(2, 1, -0.4), Vec3d(0, 0, 2)}) {
    const Vec2d expected = *stereographic(plane)(d);
    EXPECT_LT((*enhanced_unified(plane, 0.5, 1)(d) - expected).norm(), 1e-9);
    EXPECT_LT((*double_sphere(plane, 0, 0.5)(d) - expected).norm(), 1e-9);
    EXPECT_LT((*omnidirectional(half, 1, {})(d) - expected).norm(), 1e-9);
  }
}

TEST(SourceProjection, FieldOfViewIsTheAngleOfItsPaper) {
  // r_d = atan(2 r_u tan(w / 2)) / w; with 2 tan(w / 2) = 1 the distance is the angle itself over w.
  const double w = 2 * std::atan(0.5);
  const auto project = field_of_view({{100, 100}, {50, 60}}, w);
  for (const double theta : {0.0, 0.3, 1.2})
    EXPECT_LT((*project({std::sin(theta), 0, std::cos(theta)}) - Vec2d(50 + 100 * theta / w, 60)).norm(),
              1e-9);
}

}  // namespace
}  // namespace lightwell::calibration
