// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/flat_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "interface/calibration_io.h"
#include "lighting/radiometer.h"
#include "tests/integration/photometric/synthetic_sensor.h"

namespace lightwell {
namespace {

using test::SyntheticSensor;
using test::turned_takes;

TEST(FlatFit, TheClaimedErrorOfVignettingHoldsUnderColumnNoise) {
  constexpr int kSeeds = 200;
  int inside = 0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    SyntheticSensor sensor(61, 45);
    sensor.random.seed(seed);
    sensor.truth.vignetting = {-0.1, -0.04, 0};  // two terms beyond doubt: how many is not the question here
    sensor.give_pattern(3, 1, 0);
    const auto fit =
        calibration::fit_flat_field({{"even", sensor.even(800)}}, std::nullopt, sensor.lens, sensor.response);
    ASSERT_TRUE(fit) << fit.error().message;
    const double theta = 1.2;
    const Eigen::Vector3d row(std::pow(theta, 2), std::pow(theta, 4), std::pow(theta, 6));
    const double sigma = std::sqrt(row.dot(fit->covariance * row));
    inside += std::abs(fit->flat.transmission(theta) - sensor.truth.transmission(theta)) < 1.96 * sigma;
  }
  // 95 % of 200, and three standard deviations of √(200 · .95 · .05) = 3.1.
  EXPECT_GE(inside, 181);
  EXPECT_LE(inside, 199);
}

TEST(FlatFit, ATiltedSceneIsMultipliedByTheVignetting) {
  SyntheticSensor sensor(161, 120);
  sensor.give_pattern(1, 1, 0);
  const double tilt = 0.15;
  const auto tilted = sensor.mean([&](const Vec3d& d) {
    const Vec2d pixel = sensor.lens.project(d);
    const double x = (pixel.x() - sensor.lens.center.x()) / sensor.lens.focal.x() / sensor.lens.max_theta_rad;
    return 1500 * (1 + tilt * x);
  });
  const auto straight = sensor.even(1500);
  for (const auto& [take, tilt_of_it] : {std::pair{straight, 0.0}, std::pair{tilted, tilt}}) {
    const auto fit =
        calibration::fit_flat_field({{"even", take}}, std::nullopt, sensor.lens, sensor.response);
    ASSERT_TRUE(fit) << fit.error().message;
    EXPECT_NEAR(fit->tilt, tilt_of_it, 1e-3);  // 1.4 codes of 3000, 161 columns
    for (double theta = 0.1; theta < sensor.lens.max_theta_rad; theta += 0.1) {
      const Eigen::Vector3d row(std::pow(theta, 2), std::pow(theta, 4), std::pow(theta, 6));
      const double sigma = std::sqrt(row.dot(fit->covariance * row));
      // One in 16000 lies beyond.
      EXPECT_LT(std::abs(fit->flat.transmission(theta) - sensor.truth.transmission(theta)), 4 * sigma)
          << theta;
      EXPECT_LT(sigma, 1e-3) << theta;  // 1.4 codes of 3000 in some 10⁴ pixels, 161 columns
    }
    double square = 0, n = 0;
    for (std::size_t i = 0; i < sensor.truth.offset_codes.size(); ++i) {
      if (sensor.lens.theta_rad(Vec2d(static_cast<double>(i % 161), static_cast<double>(i / 161))) >
          85 * kPi / 180)
        continue;
      square += std::pow(static_cast<double>(fit->flat.offset_codes[i] - sensor.truth.offset_codes[i]), 2);
      ++n;
    }
    // As expect_offsets has it.
    EXPECT_LT(square / n, 1.05 * std::pow(fit->offset_sigma_codes, 2) +
                              10.8 * std::pow(fit->offset_shared_sigma_codes, 2));
  }
}

TEST(FlatFit, AWrongToeOfTheResponseDoesNotBecomeAnOffsetOfEveryPixel) {
  SyntheticSensor sensor(81, 60);
  const Response truth{LogResponse{800, 208, 0.05}, 12, 180, 4095, 10000};
  sensor.response = truth;
  sensor.give_pattern(2, 1, 0);
  const auto dark = sensor.even(0), even = sensor.even(500);
  double mean = 0, inside = 0;  // of the true pattern in the field: of a level, not of the pattern
  const auto in_field = [&](std::size_t i) {
    return sensor.lens.theta_rad(Vec2d(static_cast<double>(i % 81), static_cast<double>(i / 81))) <
           sensor.lens.max_theta_rad;
  };
  for (std::size_t i = 0; i < dark.code.size(); ++i)
    if (in_field(i)) mean += static_cast<double>(sensor.truth.offset_codes[i]), ++inside;
  mean /= inside;
  Response wrong = truth;
  wrong.model = LogResponse{800, 208, 0.02};  // at 500 cd/m² less than a fiftieth of a code
  const double toe_error = 208 * std::log(0.05 / 0.02);
  const auto expect_pattern = [&](const calibration::FlatFit& fit) {
    // The middle half's mean against the mean: their difference is below a fifth of 2.2 codes' scatter, √(81 columns).
    const double level = 2.2 / 9 * 3;
    EXPECT_NEAR(fit.dark_level_error_codes[0], toe_error + mean, level);
    const double taken = fit.dark_level_error_codes[0] - toe_error;
    double worst = 0;
    for (std::size_t i = 0; i < fit.flat.offset_codes.size(); ++i)
      worst = std::max(worst, std::abs(static_cast<double>(fit.flat.offset_codes[i]) + taken -
                                       static_cast<double>(sensor.truth.offset_codes[i])));
    EXPECT_LT(worst, 1.0 / 8 * 5);  // a code of noise over √64, five times: 4860 pixels
    const auto report = calibration::report_to_json(fit);
    EXPECT_EQ(report.at("dark_level_error_codes")[0], fit.dark_level_error_codes[0]);
  };
  const auto fit = calibration::fit_flat_field({{"even", even}}, dark, sensor.lens, wrong);
  ASSERT_TRUE(fit) << fit.error().message;
  expect_pattern(*fit);
  const std::vector<double> angles = {-50, 0, 50};
  std::vector<calibration::FlatTake> turned;
  for (const double angle : angles) turned.push_back({"turned " + std::to_string(angle), even});
  const auto by_turning = calibration::fit_turned_flat_field(turned, angles, dark, sensor.lens, wrong);
  ASSERT_TRUE(by_turning) << by_turning.error().message;
  expect_pattern(*by_turning);

  wrong.model = LogResponse{800, 208, 0};
  for (const auto& refused : {calibration::fit_flat_field({{"even", even}}, dark, sensor.lens, wrong),
                              calibration::fit_turned_flat_field(turned, angles, dark, sensor.lens, wrong)}) {
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::bad_input);
    EXPECT_THAT(refused.error().message, testing::HasSubstr("parameters.c = 0"));
  }
}

TEST(FlatFit, GainsComeFromSeveralLevelsOfALinearSensor) {
  SyntheticSensor sensor(81, 60);
  sensor.give_pattern(2, 1, 0.02);
  const auto one =
      calibration::fit_flat_field({{"a", sensor.even(1500)}}, std::nullopt, sensor.lens, sensor.response);
  ASSERT_TRUE(one) << one.error().message;
  EXPECT_TRUE(one->flat.gain.empty());
  const std::vector<calibration::FlatTake> levels = {
      {"a", sensor.even(1500)}, {"b", sensor.even(700)}, {"c", sensor.even(150)}};
  const auto several = calibration::fit_flat_field(levels, std::nullopt, sensor.lens, sensor.response);
  ASSERT_TRUE(several) << several.error().message;
  ASSERT_FALSE(several->flat.gain.empty());
  EXPECT_NEAR(several->gain_rms, 0.02, 0.002);  // as made; 3600 pixels
  // Gains count from what the levels and the vignetting took for 1: 2 % of scatter in some 2800 pixels of the field moves
  // eight parameters, .02 √(8/2800) = 0.11 %; in 99.9 % of cases by less than 1.8 times that (χ² of 8 degrees, 26.1).
  EXPECT_NEAR(several->gain_sigma, 0.0011, 0.0006);
  EXPECT_LT(sensor.gain_error(several->flat), 1.8 * several->gain_sigma);

  SyntheticSensor darkened = sensor;
  const auto dark = darkened.even(0);
  const auto with_dark =
      calibration::fit_flat_field({{"a", darkened.even(1500)}}, dark, sensor.lens, sensor.response);
  ASSERT_TRUE(with_dark) << with_dark.error().message;
  ASSERT_FALSE(with_dark->flat.gain.empty());
  EXPECT_LT(sensor.gain_error(with_dark->flat), 1.8 * with_dark->gain_sigma);
}

TEST(FlatFit, GainsThatNoiseHidesAreLeftOut) {
  SyntheticSensor sensor(81, 60);
  sensor.give_pattern(2, 1, 0);
  const std::vector<calibration::FlatTake> levels = {{"a", sensor.even(1500)}, {"b", sensor.even(150)}};
  const auto none = calibration::fit_flat_field(levels, std::nullopt, sensor.lens, sensor.response);
  ASSERT_TRUE(none) << none.error().message;
  EXPECT_TRUE(none->flat.gain.empty());
  EXPECT_TRUE(std::isfinite(none->gain_sigma));  // it could have been told

  sensor.response = {LogResponse{800, 208, 0.05}, 12, 180, 4095,
                     10000};  // offset and gain are the same thing
  sensor.give_pattern(2, 1, 0.02);
  const auto log = calibration::fit_flat_field({{"a", sensor.even(1500)}, {"b", sensor.even(15)}},
                                               std::nullopt, sensor.lens, sensor.response);
  ASSERT_TRUE(log) << log.error().message;
  EXPECT_TRUE(log->flat.gain.empty());
}

TEST(FlatFit, AGainIsWrittenReadAndTakenOutOfTheLight) {
  SyntheticSensor sensor(61, 45);
  sensor.give_pattern(0, 0, 0.1);
  Calibration calibration;
  calibration.response = sensor.response;
  calibration.lens = sensor.lens;
  calibration.flat = sensor.truth;
  const auto read = calibration_from_json(calibration_to_json(calibration), "attached");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_NE(read->id, [&] {
    Calibration other = calibration;
    other.flat.gain.clear();
    return calibration_id(other);
  }());
  Calibration dead = calibration;
  dead.flat.gain[5] = 1000;
  const Status refused = check(dead.flat, dead.lens);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, testing::HasSubstr("flat.gain[5] = 1000"));
  sensor.noise_codes = 0;
  const calibration::MeanFrame even = sensor.even(900);
  std::vector<std::byte> codes;
  for (const double code : even.code) {
    const auto word = static_cast<unsigned>(std::lround(code));
    codes.push_back(static_cast<std::byte>(word & 255));
    codes.push_back(static_cast<std::byte>(word >> 8));
  }
  auto radiometer = Radiometer::create(*read, even.format, {});
  ASSERT_TRUE(radiometer) << radiometer.error().message;
  PolarMap map = radiometer->make_map();
  radiometer->develop(codes, 10000, map);
  for (std::size_t b = 0; b < map.grid.size(); ++b)
    if (map.grid.ring_edge_rad(static_cast<int>(b) / map.grid.sectors) < 80 * kPi / 180) {
      // Half a code of 2 · 900 · T; T falls to 0.76. Gains are stored to 1/16384 of a half.
      ASSERT_NEAR(map.radiance[b] / 900, 1, 6e-4) << b;
    }
}

TEST(FlatFit, TurningTellsVignettingFromAnUnevenScene) {
  const std::vector<double> angles = {-60, -30, 0, 30, 60};
  int inside = 0, all = 0;
  const std::vector<std::array<double, 3>> lenses = {
      {-0.12, -0.01, 0.0}, {-0.2, 0.0, 0.0}, {-0.05, -0.04, 0.006}};
  for (const std::array<double, 3>& vignetting : lenses) {
    SyntheticSensor sensor(161, 120);
    sensor.truth.vignetting = vignetting;
    const auto fit = calibration::fit_turned_flat_field(turned_takes(sensor, angles, Vec3d::UnitY()), angles,
                                                        std::nullopt, sensor.lens, sensor.response);
    ASSERT_TRUE(fit) << fit.error().message;
    for (double theta = 0.2; theta < 1.5; theta += 0.1) {
      const Eigen::Vector3d row(std::pow(theta, 2), std::pow(theta, 4), std::pow(theta, 6));
      const double sigma = std::sqrt(row.dot(fit->covariance * row));
      // Pixels of 1.1 degrees sample cells of two unevenly: 2 % of scatter, over some 5000 cells and three terms.
      EXPECT_NEAR(fit->flat.transmission(theta), sensor.truth.transmission(theta), 0.01) << theta;
      EXPECT_LT(sigma, 0.01);
      ++all;
      inside += std::abs(fit->flat.transmission(theta) - sensor.truth.transmission(theta)) < 4 * sigma + 1e-3;
    }
    EXPECT_TRUE(fit->flat.offset_codes.empty());
  }
  EXPECT_EQ(inside, all);
}

TEST(FlatFit, TurnsThatTellNothingAreRefused) {
  SyntheticSensor sensor(81, 60);
  const auto refused = [&](const std::vector<calibration::FlatTake>& takes, const std::vector<double>& angles,
                           const std::string& says) {
    const auto fit =
        calibration::fit_turned_flat_field(takes, angles, std::nullopt, sensor.lens, sensor.response);
    ASSERT_FALSE(fit) << says;
    EXPECT_EQ(fit.error().kind, ErrorKind::bad_input);
    EXPECT_NE(fit.error().message.find(says), std::string::npos) << fit.error().message;
  };
  refused(turned_takes(sensor, {0, 0, 0}, Vec3d::UnitY()), {0, 0, 0}, "turn the camera farther");
  refused(turned_takes(sensor, {0}, Vec3d::UnitY()), {0}, "number of turned takes = 1");
  refused(turned_takes(sensor, {0, 30, 60}, Vec3d::UnitY()), {0, -30, -60}, "are the angles right");
}

}  // namespace
}  // namespace lightwell
