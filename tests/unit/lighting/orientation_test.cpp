// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/orientation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numeric>

#include "lighting/lens.h"
#include "lighting/light_pipeline.h"
#include "tests/support/radiometer_checks.h"

namespace lightwell {
namespace {

using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// world_from_camera of a camera that looked up and was then turned about a horizontal axis.
Eigen::Matrix3d tilted(double angle_rad, double axis_azimuth_rad) {
  Eigen::Matrix3d level;
  level.col(0) = world_from_camera(Vec3d::UnitX());
  level.col(1) = world_from_camera(Vec3d::UnitY());
  level.col(2) = world_from_camera(Vec3d::UnitZ());
  const Vec3d axis(std::sin(axis_azimuth_rad), 0, std::cos(axis_azimuth_rad));
  return Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix() * level;
}

// What its accelerometer reads: the floor's push, upward.
Vec3d reading(const Eigen::Matrix3d& world_from_camera_truth, double unit = 9.81) {
  return unit * world_from_camera_truth.transpose() * Vec3d::UnitY();
}

TEST(Orientation, ALevelCameraIsTheUntiltedFrameToTheLastBit) {
  const auto zenith = zenith_from_accelerometer({0, 0, 9.81});
  ASSERT_TRUE(zenith.ok());
  EXPECT_EQ(*zenith, Vec3d(Vec3d::UnitZ()));
  const Eigen::Matrix3d rotation = world_from_camera_rotation(*zenith);
  for (const Vec3d& d : {Vec3d(1, 2, 3), Vec3d(-0.3, 0.1, 0.7)})
    EXPECT_EQ(rotation * d, world_from_camera(d));
}

TEST(Orientation, ATiltIsUndoneInWhateverUnitGravityIsRead) {
  for (const double angle : {1e-9, 0.01, 0.4, 1.5, 3.0})
    for (const double azimuth : {0.0, 1.0, 2.5, 4.0, 6.0})
      for (const double unit : {1.0, 9.81, 16384.0}) {
        const Eigen::Matrix3d truth = tilted(angle, azimuth);
        const auto zenith = zenith_from_accelerometer(reading(truth, unit));
        ASSERT_TRUE(zenith.ok()) << angle << ": " << zenith.error().message;
        // Rounding of some 1e-15, which straight down magnifies: by 1 / sin(3) = 7 at 3 radians.
        EXPECT_LT((world_from_camera_rotation(*zenith) - truth).norm(), 1e-13) << angle << " " << azimuth;
      }
}

TEST(Orientation, TheZenithComesOutUpAndTheTurnIsTheLeast) {
  for (const Vec3d& v : {Vec3d(0.1, 0.2, 0.9), Vec3d(-1, 0, 0), Vec3d(0.3, -0.8, -0.4), Vec3d(0, 0.01, -1)}) {
    const Vec3d zenith = v.normalized();
    const Eigen::Matrix3d rotation = world_from_camera_rotation(zenith);
    // Half a degree from straight down 1 + cos loses five digits.
    EXPECT_LT((rotation * zenith - Vec3d::UnitY()).norm(), 1e-10);
    EXPECT_LT((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_NEAR(rotation.determinant(), 1, 1e-12);
    const Eigen::AngleAxisd turn(rotation * tilted(0, 0).transpose());
    EXPECT_NEAR(turn.angle(), std::acos(zenith.z()), 1e-9);
    EXPECT_NEAR(turn.axis().y(), 0, 1e-9);  // about a horizontal axis: no turn about the vertical
  }
}

TEST(Orientation, WhatIsNoReadingOfASensorAtRestIsRefused) {
  const std::pair<Vec3d, const char*> cases[] = {{{kNan, 0, 9.8}, "gravity[0]"},
                                                 {{0, kInfinity, 9.8}, "gravity[1]"},
                                                 {{0, 0, 0}, "length"},
                                                 {{0, 0, 0.001}, "length"},
                                                 {{0, 0, -9.81}, "straight down"},
                                                 {{0.01, 0.01, -9.81}, "straight down"}};
  for (const auto& [v, names] : cases) {
    const auto zenith = zenith_from_accelerometer(v);
    ASSERT_FALSE(zenith.ok()) << names;
    EXPECT_EQ(zenith.error().kind, ErrorKind::bad_input);
    EXPECT_THAT(zenith.error().message, HasSubstr(names));
  }
  EXPECT_TRUE(zenith_from_accelerometer({1e200, 0, 1e200}).ok());  // its square is not finite
  Lens lens;
  lens.zenith = {0, 0, 2};
  EXPECT_FALSE(check(lens).ok());
  lens.zenith = {0, kNan, 1};
  EXPECT_FALSE(check(lens).ok());
}

// A level camera that sees three lamps on a dim sky, and the same camera tilted.
class TiltedView : public testing::Test {
 protected:
  static constexpr int kSize = 300;
  struct Lamp {
    Vec3d direction;
    double radiance;
  };
  static std::vector<Lamp> lamps() {
    return {{Vec3d(0.1, 0.9, 0.2).normalized(), 20000},
            {Vec3d(-0.6, 0.7, 0.1).normalized(), 50000},
            {Vec3d(0.3, 0.6, -0.6).normalized(), 30000}};
  }
  static double radiance(const Vec3d& world) {
    double sum = world.y() > 0 ? 20 : 0;
    constexpr double kWidth = 0.04;  // radians
    for (const Lamp& lamp : lamps())
      sum += lamp.radiance * std::exp((lamp.direction.dot(world) - 1) / (kWidth * kWidth));
    return sum;
  }
  static Calibration camera() {
    Calibration c = test::log_camera(kSize, kSize, 16);
    c.flat = {};
    return c;
  }
  static PolarMap developed(const Calibration& c, const Eigen::Matrix3d& world_from_camera_truth) {
    const FrameFormat format{kSize, kSize, PixelFormat::mono16};
    std::vector<std::uint16_t> codes;
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x)
        codes.push_back(static_cast<std::uint16_t>(
            std::lround(c.response.code(radiance(world_from_camera_truth * c.lens.unproject(Vec2d(x, y)))))));
    return test::develop(c, format, codes);
  }
  struct Cluster {
    double illuminance = 0;
    Vec3d direction = Vec3d::Zero();
  };
  // Of the lights within 15 degrees of a lamp.
  static Cluster around(const Lamp& lamp, std::span<const DirectionalLight> lights) {
    Cluster out;
    for (const DirectionalLight& light : lights) {
      const Vec3d d = light.direction.cast<double>();
      if (d.dot(lamp.direction) < std::cos(15 * kPi / 180)) continue;
      const auto power = static_cast<double>(light.illuminance[1]);
      out.illuminance += power;
      out.direction += power * d;
    }
    out.direction.normalize();
    return out;
  }
  static std::vector<DirectionalLight> lights_of(const PolarMap& map) {
    LightPipelineOptions options;
    options.filter = TemporalFilter::none;
    options.count = 3000;
    options.clusters = 0;
    auto pipeline = LightPipeline::create(map.grid, 1, options);
    EXPECT_TRUE(pipeline.ok());
    const auto lights = pipeline->process(map);
    return {lights.begin(), lights.end()};
  }
};

TEST_F(TiltedView, GivesTheSameLightsOnceGravityIsKnown) {
  const Calibration level = camera();
  const auto expected = lights_of(developed(level, tilted(0, 0)));
  for (const double azimuth : {0.3, 2.0, 5.0}) {
    const Eigen::Matrix3d truth = tilted(0.35, azimuth);  // 20 degrees
    Calibration c = level;
    const auto blind = lights_of(developed(c, truth));
    c.lens.zenith = *zenith_from_accelerometer(reading(truth));
    const auto corrected = lights_of(developed(c, truth));
    double worst_without = 0;
    for (const Lamp& lamp : lamps()) {
      const Cluster a = around(lamp, expected), b = around(lamp, corrected), without = around(lamp, blind);
      ASSERT_GT(a.illuminance, 0);
      // The dimmest lamp has some 500 of the 3000 lights: a low-discrepancy count is off by a dozen at most.
      EXPECT_NEAR(b.illuminance / a.illuminance, 1, 0.025);
      EXPECT_LT(std::acos(std::min(1.0, a.direction.dot(b.direction))) * 180 / kPi,
                0.7);  // bins are a degree wide
      worst_without = std::max(worst_without, std::abs(without.illuminance / a.illuminance - 1));
    }
    EXPECT_GT(worst_without, 0.5) << "the tilt should have been seen";
  }
}

TEST_F(TiltedView, MeasuresTheLuneThatLensAndHorizonShare) {
  for (const double tilt : {0.1, 0.35, 1.0}) {
    Calibration c = camera();
    c.lens.zenith = *zenith_from_accelerometer(reading(tilted(tilt, 1.0)));
    const PolarMap map = developed(c, tilted(tilt, 1.0));
    const double measured = std::accumulate(map.solid_angle_sr.begin(), map.solid_angle_sr.end(), 0.0,
                                            [](double sum, float v) { return sum + static_cast<double>(v); });
    // Two hemispheres whose axes are apart by the tilt share 2 (π − tilt) sr. Pixels on the horizon are taken or left
    // whole: half a pixel of 0.6 degrees at most along a half circle, on average far less.
    EXPECT_NEAR(measured, 2 * (kPi - tilt), 0.01);
    EXPECT_NEAR(static_cast<double>(map.coverage), 2 * (kPi - tilt) / (4 * kPi), 0.001);
  }
}

}  // namespace
}  // namespace lightwell
