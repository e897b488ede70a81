// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/colour_fit.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <random>

namespace lightwell::calibration {
namespace {

Eigen::Matrix3d truth() {
  Eigen::Matrix3d m;
  m << 1.7, -0.6, -0.1, -0.2, 1.5, -0.3, 0.05, -0.5, 1.45;
  return m;
}

std::vector<ColourPatch> chart(double error, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(0.05, 1);
  std::normal_distribution<double> normal;
  std::vector<ColourPatch> patches;
  for (int i = 0; i < 24; ++i) {
    const Eigen::Vector3d colour =
        i == 3 ? Eigen::Vector3d(90, 90, 90)
               : Eigen::Vector3d(80 * any(random), 80 * any(random), 80 * any(random));
    Eigen::Vector3d camera = truth().inverse() * colour;
    for (Eigen::Index c = 0; c < 3; ++c) camera[c] *= 1 + error * normal(random);
    patches.push_back({"patch " + std::to_string(i), camera, colour, i > 20});
  }
  patches[3].name = "White";
  return patches;
}

TEST(ColourFit, ExactChartGivesTheExactMatrix) {
  const auto fit = fit_colour(chart(0), "chart.csv");
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_LT((fit->rec709_from_camera - truth()).cwiseAbs().maxCoeff(), 1e-9);  // rounding, condition 10
  EXPECT_LT(fit->rms_error, 1e-9);
}

TEST(ColourFit, WhiteStaysExactlyWhereTheOthersAreNoisy) {
  for (unsigned seed = 1; seed < 20; ++seed) {
    const auto patches = chart(0.02, seed);
    const auto fit = fit_colour(patches, "chart.csv");
    ASSERT_TRUE(fit) << fit.error().message;
    EXPECT_EQ(fit->white, "White");
    EXPECT_LT((fit->rec709_from_camera * patches[3].camera - patches[3].rec709).norm(), 1e-9 * 90);
    EXPECT_LT((fit->rec709_from_camera - truth()).cwiseAbs().maxCoeff(),
              0.2);  // 2 % of 24 patches, condition 10
    EXPECT_TRUE(fit->residuals[23].check);
  }
}

TEST(ColourFit, NoOtherMatrixThatKeepsWhiteIsBetter) {
  const auto patches = chart(0.05);
  const auto fit = fit_colour(patches, "chart.csv");
  ASSERT_TRUE(fit);
  const auto cost = [&](const Eigen::Matrix3d& m) {
    double sum = 0;
    for (const ColourPatch& p : patches)
      if (!p.check)
        sum += (m * p.camera - p.rec709).squaredNorm() /
               std::pow(p.rec709.dot(Eigen::Vector3d(0.2126, 0.7152, 0.0722)), 2);
    return sum;
  };
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const Eigen::Vector3d white = patches[3].camera.normalized();
  for (int i = 0; i < 200; ++i) {
    Eigen::Matrix3d step;
    for (Eigen::Index k = 0; k < 9; ++k) step(k / 3, k % 3) = 1e-3 * normal(random);
    step -= step * white * white.transpose();  // white unmoved
    EXPECT_GT(cost(fit->rec709_from_camera + step), cost(fit->rec709_from_camera));
  }
}

// A reflection on one patch: the same matrix as without it, to what the noise of the others leaves.
TEST(ColourFit, OneBadPatchIsLeftOutAndNoGoodOneIs) {
  for (unsigned seed = 1; seed < 20; ++seed) {
    auto patches = chart(0.02, seed);
    const auto clean = fit_colour(patches, "chart.csv");
    ASSERT_TRUE(clean);
    EXPECT_EQ(clean->rejected, "");
    patches[7].camera += Eigen::Vector3d(60, 10, 40);
    const auto fit = fit_colour(patches, "chart.csv");
    ASSERT_TRUE(fit) << fit.error().message;
    EXPECT_EQ(fit->rejected, "patch 7") << seed;
    patches.erase(patches.begin() + 7);
    EXPECT_LT((fit->rec709_from_camera - fit_colour(patches, "c.csv")->rec709_from_camera).norm(), 1e-9);
  }
}

TEST(ColourFit, PatchesInAnotherOrderAndAnotherScaleAreRefused) {
  auto patches = chart(0);
  for (std::size_t i = 0; i < 10; ++i) std::swap(patches[i].rec709, patches[20 - i].rec709);
  EXPECT_NE(fit_colour(patches, "c.csv").error().message.find("in the chart's order"), std::string::npos);
  patches = chart(0);
  for (ColourPatch& p : patches) p.rec709 *= 100;
  EXPECT_NE(fit_colour(patches, "c.csv").error().message.find("luminance of White = 9000"),
            std::string::npos);
}

TEST(ColourFit, TooFewPatchesAndGreyOnesAreRefused) {
  auto patches = chart(0);
  patches.resize(3);
  EXPECT_NE(fit_colour(patches, "c.csv").error().message.find("number of patches to fit = 3"),
            std::string::npos);
  std::vector<ColourPatch> grey;
  for (int i = 1; i < 8; ++i)
    grey.push_back({"g", Eigen::Vector3d::Constant(i), Eigen::Vector3d::Constant(i), false});
  EXPECT_NE(fit_colour(grey, "c.csv").error().message.find("lie in a plane"), std::string::npos);
}

}  // namespace
}  // namespace lightwell::calibration
