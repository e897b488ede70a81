// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/lens.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "lighting/direction.h"

namespace lightwell {
namespace {

Lens equidistant() {
  return {{640, 480}, {150, 150}, {319.5, 239.5}, {0, 0, 0, 0}, kPi / 2};
}

// All kinds of field: plain, distorted with unequal axes, wide beyond 180 degrees, one pixel for half the
// sphere.
std::vector<Lens> lenses() {
  return {equidistant(),
          {{640, 480}, {140.3, 143.1}, {322.7, 236.2}, {-0.02, 0.004, -0.001, 0.0001}, kPi / 2},
          {{320, 321}, {70, 69}, {158.1, 161.4}, {0.01, -0.005, 0.0004, 0}, 110 * kPi / 180},
          {{1, 1}, {0.3, 0.3}, {0, 0}, {0, 0, 0, 0}, kPi / 2},
          {{5, 3}, {0.9, 0.8}, {1.7, 1.2}, {0.03, 0, 0, 0}, 100 * kPi / 180}};
}

double cap_sr(const Lens& lens) {
  return 2 * kPi * (1 - std::cos(lens.max_theta_rad));
}

TEST(Lens, RoundTripIsBelowANanoradianInsideTheField) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const Lens& lens : lenses()) {
    ASSERT_TRUE(check(lens));
    for (int i = 0; i < 2000; ++i) {
      const double theta = lens.max_theta_rad * (i < 10 ? std::pow(10, -i) : unit(random));
      const double phi = 2 * kPi * unit(random);
      const Vec3d d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
      const Vec3d back = lens.unproject(lens.project(3.7 * d));
      EXPECT_LT(d.cross(back).norm() + (d.dot(back) < 0 ? 1 : 0), 1e-9);
      EXPECT_NEAR(lens.theta_rad(lens.project(d)), theta, 1e-9);
    }
  }
}

TEST(Lens, JacobianIsTheSlopeOfTheProjection) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (const Lens& lens : lenses())
    for (int i = 0; i < 200; ++i) {
      Vec3d d(normal(random), normal(random), normal(random));
      if (i < 3) d = {i == 1 ? 1e-12 : 0, 0, 2};  // on the axis, where the formula changes
      const LensJacobian j = project_with_jacobian(lens, d);
      EXPECT_EQ(j.pixel, lens.project(d));
      // Central differences err by about h² times the third derivative: relative 1e-6 of the largest entry.
      const auto expect_slope = [&](const Vec2d& plus, const Vec2d& minus, double h, const Vec2d& slope,
                                    double largest) {
        EXPECT_LT(((plus - minus) / (2 * h) - slope).norm(), 1e-6 * std::max(1.0, largest));
      };
      const double h = 1e-5 * d.norm();
      for (Eigen::Index c = 0; c < 3; ++c) {
        const Vec3d step = h * Vec3d::Unit(c);
        const double near_axis = d.head<2>().norm() / d.norm();
        if (near_axis < 0.01 && i >= 3) continue;  // there the differences themselves lose their digits
        expect_slope(lens.project(d + step), lens.project(d - step), h, j.dpixel_ddirection.col(c),
                     j.dpixel_ddirection.norm());
      }
      for (Eigen::Index c = 0; c < 8; ++c) {
        const auto moved = [&](double by) {
          Lens l = lens;
          double* const numbers[8] = {&l.focal.x(), &l.focal.y(), &l.center.x(), &l.center.y(),
                                      &l.k[0],      &l.k[1],      &l.k[2],       &l.k[3]};
          *numbers[c] += by;
          return l.project(d);
        };
        expect_slope(moved(1e-4), moved(-1e-4), 1e-4, j.dpixel_dlens.col(c), lens.project(d).norm());
      }
    }
}

TEST(Lens, EquidistantProjectionIsItsClosedForm) {
  const Lens lens = equidistant();
  const Vec2d right = lens.project(Vec3d(1, 0, 1));
  EXPECT_NEAR(right.x(), 319.5 + 150 * kPi / 4, 1e-12 * 319);
  EXPECT_NEAR(right.y(), 239.5, 1e-12 * 239);
  EXPECT_EQ(lens.project(Vec3d(0, 0, 5)), lens.center);
  EXPECT_EQ(lens.unproject(lens.center), Vec3d(0, 0, 1));
  EXPECT_NEAR(lens.project(Vec3d(0, 0, -1)).x(), 319.5 + 150 * kPi, 1e-9);
}

TEST(Lens, TopOfTheImageIsAzimuthZeroAndItsRightSideNinetyDegrees) {
  const Lens lens = equidistant();
  const Spherical top = spherical_from_direction(world_from_camera(lens.unproject({319.5, 100})));
  const Spherical right = spherical_from_direction(world_from_camera(lens.unproject({400, 239.5})));
  EXPECT_NEAR(top.lambda_rad, 0, 1e-12);
  EXPECT_NEAR(right.lambda_rad, kPi / 2, 1e-12);
  EXPECT_NEAR(top.theta_rad, 139.5 / 150, 1e-12);
  EXPECT_EQ(camera_from_world(world_from_camera(Vec3d(1, 2, 3))), Vec3d(1, 2, 3));
}

TEST(Lens, BeyondTheFieldTheAngleStaysBeyondItAndEndsAtPi) {
  // θd falls again beyond the field: a careless solver would land back inside.
  const Lens lens = {{640, 480}, {150, 150}, {319.5, 239.5}, {-0.08, 0, 0, 0}, kPi / 2};
  ASSERT_TRUE(check(lens));
  const double edge = lens.project(Vec3d(1, 0, 0)).x();
  for (double x = edge + 0.5; x < 5000; x *= 1.1) {
    EXPECT_GT(lens.theta_rad({x, 239.5}), kPi / 2);
    EXPECT_LE(lens.theta_rad({x, 239.5}), kPi);
  }
  EXPECT_EQ(lens.theta_rad({1e5, 239.5}), kPi);
}

TEST(Lens, PixelSolidAnglesSumToTheCap) {
  for (const Lens& lens : lenses()) {
    double sum = 0;
    const int margin = 40;  // the circle may reach past the image; the sum runs over all of it
    for (int y = -margin; y < lens.image_size[1] + margin; ++y)
      for (int x = -margin; x < lens.image_size[0] + margin; ++x)
        sum += lens.pixel_solid_angle_sr(Vec2d(x, y));
    EXPECT_NEAR(sum / cap_sr(lens), 1, 1e-9) << lens.image_size[0];  // Gauss–Legendre's error is far below
  }
}

// Solid angle of a triangle of directions (Van Oosterom and Strackee 1983).
double triangle_sr(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return 2 * std::atan2(std::abs(a.dot(b.cross(c))), 1 + a.dot(b) + b.dot(c) + c.dot(a));
}

// The pixel cut into n × n cells, each two spherical triangles; a cell counts where its centre is in the
// field.
double slow_solid_angle(const Lens& lens, const Vec2d& pixel, int n) {
  double sum = 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto at = [&](double u, double v) {
        return lens.unproject(pixel + Vec2d((i + u) / n - 0.5, (j + v) / n - 0.5));
      };
      if (lens.theta_rad(pixel + Vec2d((i + 0.5) / n - 0.5, (j + 0.5) / n - 0.5)) > lens.max_theta_rad)
        continue;
      sum += triangle_sr(at(0, 0), at(1, 0), at(1, 1)) + triangle_sr(at(0, 0), at(1, 1), at(0, 1));
    }
  return sum;
}

TEST(Lens, PixelSolidAngleAgreesWithSphericalTriangles) {
  const Lens lens = lenses()[1];
  for (const Vec2d& pixel :
       {Vec2d(322, 236), Vec2d(323, 236), Vec2d(400, 100), Vec2d(321, 30), Vec2d(500, 300)})
    EXPECT_NEAR(lens.pixel_solid_angle_sr(pixel) / slow_solid_angle(lens, pixel, 8), 1,
                1e-6);  // triangles err as 1/n²
  const Lens coarse = lenses()[4];
  for (const Vec2d& pixel : {Vec2d(1, 1), Vec2d(2, 1), Vec2d(1, 2)})
    EXPECT_NEAR(coarse.pixel_solid_angle_sr(pixel) / slow_solid_angle(coarse, pixel, 300), 1,
                2e-3);  // border cells
}

TEST(Lens, BorderPixelsCountTheirInnerPartOnly) {
  const Lens lens = equidistant();
  const double edge = 319.5 + 150 * kPi / 2;  // 555.12 on the axis
  const double inside = lens.pixel_solid_angle_sr({554, 239.5});
  const double crossed = lens.pixel_solid_angle_sr({555, 239.5});
  EXPECT_EQ(lens.pixel_solid_angle_sr({557, 239.5}), 0);
  EXPECT_EQ(lens.pixel_solid_angle_sr({639, 0}), 0);
  // The pixel reaches from 554.5; at the rim the density changes by less than 1 % a pixel, the circle's bow
  // is h²/8R.
  EXPECT_NEAR(crossed / inside, edge - 554.5, 0.01);
}

TEST(Lens, CheckNamesFieldValueAndRange) {
  const auto message = [](const Lens& lens) {
    const Status status = check(lens);
    EXPECT_FALSE(status);
    if (status) return std::string();
    EXPECT_EQ(status.error().kind, ErrorKind::bad_input);
    return status.error().message;
  };
  Lens lens = equidistant();
  lens.focal[1] = -3;
  EXPECT_EQ(message(lens), "lens.focal[1] = -3: allowed above 0, below 1e6 pixels a radian");
  lens = equidistant();
  lens.image_size[0] = 0;
  EXPECT_NE(message(lens).find("lens.image_size[0] = 0"), std::string::npos);
  lens = equidistant();
  lens.center[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message(lens).find("lens.center[0] = nan"), std::string::npos);
  lens = equidistant();
  lens.k[2] = std::numeric_limits<double>::infinity();
  EXPECT_NE(message(lens).find("lens.k[2] = inf"), std::string::npos);
  lens = equidistant();
  lens.max_theta_rad = 4;
  EXPECT_NE(message(lens).find("lens.max_theta_rad = 4"), std::string::npos);
}

TEST(Lens, CheckFindsAProjectionThatTurnsBackHoweverNarrowly) {
  Lens lens = equidistant();
  lens.k = {-0.14, 0, 0, 0};  // slope 1 − 0.42 θ²: 0 at 88.4°
  EXPECT_FALSE(check(lens));
  lens.max_theta_rad = 85 * kPi / 180;
  EXPECT_TRUE(check(lens));
  // Slope 1 + 3 k1 t + 5 k2 t² with its minimum −1e-4 at t = 1, positive again at both ends.
  lens = equidistant();
  lens.k = {-2.0002 / 3, 1.0001 / 5, 0, 0};
  EXPECT_FALSE(check(lens));
}

}  // namespace
}  // namespace lightwell
