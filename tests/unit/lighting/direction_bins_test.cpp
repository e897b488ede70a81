// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/direction_bins.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "lighting/harmonics.h"

namespace lightwell {
namespace {

Eigen::MatrixXd harmonics_of(const DirectionBins& bins, const std::vector<Rgb>& pixels) {
  std::vector<Rgb> mean(bins.directions().size());
  bins.mean_radiance(pixels, mean);
  Eigen::MatrixXd radiance(static_cast<Eigen::Index>(mean.size()), 3);
  for (std::size_t d = 0; d < mean.size(); ++d)
    radiance.row(static_cast<Eigen::Index>(d)) = mean[d].cast<double>().matrix().transpose();
  return bins.harmonics() * radiance;
}

std::vector<Rgb> random_pixels(int count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> light(0, 9);
  std::vector<Rgb> pixels(static_cast<std::size_t>(count));
  for (Rgb& p : pixels) p = {light(random), light(random), light(random)};
  return pixels;
}

// No light is lost between pixels: the mean radiance of the sphere is the mean of the image by its exact solid angles,
// whether pixels are larger or smaller than cells.
TEST(DirectionBins, KeepAllLightOfAnImage) {
  for (const int height : {2, 16, 90}) {
    const int width = 2 * height;
    const DirectionBins bins(LatLongProbe{}, width, height, 500, 1);
    const auto pixels = random_pixels(width * height);
    Eigen::Array3d total = Eigen::Array3d::Zero();
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        total += pixels[static_cast<std::size_t>(y * width + x)].cast<double>() *
                 (std::cos(kPi * y / height) - std::cos(kPi * (y + 1) / height)) * 2 * kPi / width;
    const Eigen::MatrixXd found = harmonics_of(bins, pixels) * std::sqrt(4 * kPi);
    // Pieces are a third of a cell, .16 rad: the midpoint rule's sin θ errs by its square over 24.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found(0, c), total[c], 3e-4 * total[c]) << height;
    EXPECT_NEAR(bins.coverage(), 1, 3e-4);
  }
}

TEST(DirectionBins, AnEvenSphereIsAConstant) {
  const DirectionBins bins(LatLongProbe{}, 64, 32, 800, 4);
  const std::vector<Rgb> pixels(64 * 32, Rgb(1, 2, 3));
  const Eigen::MatrixXd found = harmonics_of(bins, pixels);
  EXPECT_NEAR(found(0, 1), 2 * std::sqrt(4 * kPi), 2e-3);
  EXPECT_LT(found.bottomRows(24).cwiseAbs().maxCoeff(), 5e-3);
}

// Every part of the picture of a ball counts alike, and what it does not see is not black.
TEST(DirectionBins, AMirrorBallsBlindConeIsFilledAndNotKnown) {
  for (const double cone_deg : {2.1, 12.0}) {
    const MirrorBallProbe ball{0.05, std::nullopt, cone_deg * kPi / 180};
    const DirectionBins bins(ball, 60, 60, 800, 4);
    const std::vector<Rgb> pixels(3600, Rgb(1, 1, 1));
    const Eigen::MatrixXd found = harmonics_of(bins, pixels);
    const double hidden = (1 - std::cos(cone_deg * kPi / 180)) / 2;
    // A pixel's pieces at the rim: 1 % of the cone's ring.
    EXPECT_NEAR(bins.coverage(), 1 - hidden, 1e-3);
    EXPECT_NEAR(found(0, 0), std::sqrt(4 * kPi), 5e-3);
    EXPECT_LT(found.bottomRows(24).cwiseAbs().maxCoeff(), 1e-2);
  }
}

TEST(DirectionBins, RaysOfABallStartOnItsSurface) {
  const DirectionBins bins(MirrorBallProbe{0.05, std::nullopt, 0.04}, 200, 200, 800, 1);
  for (const MeasuredDirection& d : bins.directions()) {
    const Vec3d half = (d.direction + Vec3d::UnitZ()).normalized();
    // A mean over a cell of .125 rad, half of that on the ball, lies inside it by the square over 24 or so; at the rim
    // cells run round the blind cone.
    if (d.direction.z() > -0.95) {
      EXPECT_LT((d.origin - 0.05 * half).norm(), 0.05 * 0.02);
    }
  }
}

TEST(DirectionBins, AFisheyeLeavesTheLowerHemisphereDark) {
  Lens lens;
  lens.image_size = {120, 120};
  lens.focal = {36, 36};
  lens.center = {59.5, 59.5};
  const DirectionBins bins(FisheyeProbe{lens}, 120, 120, 800, 2);
  EXPECT_NEAR(bins.coverage(), 0.5, 2e-3);
  const Eigen::MatrixXd found = harmonics_of(bins, std::vector<Rgb>(120 * 120, Rgb(1, 1, 1)));
  EXPECT_NEAR(found(0, 0), std::sqrt(kPi), 0.01);                  // 2π Y_00
  EXPECT_NEAR(found(2, 0), kPi * std::sqrt(3 / (4 * kPi)), 0.01);  // 2π √(3/4π) / 2
  EXPECT_NEAR(found(1, 0), 0, 1e-3);
}

TEST(DirectionBins, WhatAPictureDidNotSeeIsKnownToBeUnknown) {
  const DirectionBins bins(LatLongProbe{}, 64, 32, 200, 2);
  std::vector<Rgb> pixels(64 * 32, Rgb::Constant(3));
  for (std::size_t i = 64 * 16; i < pixels.size(); ++i)
    pixels[i].setConstant(std::numeric_limits<float>::quiet_NaN());
  std::vector<Rgb> radiance(bins.directions().size());
  bins.mean_radiance(pixels, radiance);
  for (std::size_t d = 0; d < radiance.size(); ++d) {
    const double height = bins.directions()[d].direction.y();
    if (height > 0.05) {
      EXPECT_NEAR(radiance[d].x(), 3, 1e-5) << "of what was seen, the mean";
    }
    if (height < -0.05) {
      EXPECT_TRUE(std::isnan(radiance[d].x()));
    }
  }
}

TEST(DirectionBins, APictureThatEndsAboveTheNadirHasNoDirectionsBelow) {
  const double theta_max_rad = 1.2;
  const DirectionBins bins(LatLongProbe{theta_max_rad}, 128, 64, 1000, 2);
  for (const MeasuredDirection& direction : bins.directions())
    EXPECT_GT(direction.direction.y(), std::cos(theta_max_rad));
  // The border is cut out of pieces of a third of a cell.
  EXPECT_NEAR(bins.coverage(), (1 - std::cos(theta_max_rad)) / 2, 0.005);
}

}  // namespace
}  // namespace lightwell
