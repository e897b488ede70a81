// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/moving_least_squares.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lighting/field/support_choice.h"

namespace lightwell {
namespace {

template <class Radiance>
std::vector<PlaneSample> scattered(std::size_t count, const Radiance& radiance) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> along(0, 10);
  std::vector<PlaneSample> samples(count);
  for (PlaneSample& s : samples) {
    s.at = {along(random), along(random)};
    s.radiance = radiance(s.at);
  }
  return samples;
}

Eigen::Array3f plane_of_light(const Eigen::Vector2f& at) {
  return {5 + 0.3f * at.x() - 0.2f * at.y(), 4.0f + 0.1f * at.y(), 1.0f};
}

TEST(MovingLeastSquares, AreExactForLinearRadianceAndFarBetterThanAMean) {
  const auto samples = scattered(300, plane_of_light);
  NearestSamples nearest;
  nearest.build(samples);
  for (float x = 1; x < 9; x += 0.37f)
    for (float y = 1; y < 9; y += 0.41f) {
      const Eigen::Vector2f at(x, y);
      const LocalFit fit = fit_locally(nearest, at, 12);
      // The ridge takes some .3 % of the slope over a support of a cell, more where rays are lopsided; a mean alone errs
      // by a hundred times as much.
      EXPECT_LT((fit.radiance - plane_of_light(at)).abs().maxCoeff(), 2e-3f);
    }
}

TEST(MovingLeastSquares, AreContinuousAcrossEveryChangeOfNeighbours) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> light(0, 1);
  const auto samples =
      scattered(200, [&](const Eigen::Vector2f&) { return Eigen::Array3f(light(random), 0, 1); });
  NearestSamples nearest;
  nearest.build(samples);
  constexpr float kStep = 1e-3f;
  float last = fit_locally(nearest, {2, 3.3f}, 9).radiance[0];
  for (float x = 2 + kStep; x < 8; x += kStep) {
    const float value = fit_locally(nearest, {x, 3.3f}, 9).radiance[0];
    EXPECT_LT(std::abs(value - last), 0.02f) << x;  // slopes of 1 over a spacing of .7 cells, and fits' own
    last = value;
  }
}

TEST(MovingLeastSquares, KeepTheMeanWhereRaysDoNotSay) {
  // One probe; all in one place; all on a line: nothing tells a slope across it.
  std::vector<PlaneSample> samples = {{{1, 1}, {2, 3, 4}}};
  NearestSamples nearest;
  nearest.build(samples);
  EXPECT_TRUE((fit_locally(nearest, {7, 9}, 6).radiance == Eigen::Array3f(2, 3, 4)).all());
  samples.assign(20, {{1, 1}, {2, 3, 4}});
  samples.back().radiance = {4, 3, 4};
  nearest.build(samples);
  const Eigen::Array3f heap = fit_locally(nearest, {1.5f, 1}, 40).radiance;
  EXPECT_NEAR(heap[0], 2.1f, 1e-4f);
  EXPECT_NEAR(heap[1], 3, 1e-4f);
  samples.clear();
  for (int i = 0; i < 40; ++i) {
    const auto t = static_cast<float>(i) * 0.25f;
    samples.push_back({{t, 2}, {1 + t, 1, 1}});
  }
  nearest.build(samples);
  const float on = fit_locally(nearest, {5.1f, 2}, 9).radiance[0],
              beside = fit_locally(nearest, {5.1f, 3}, 9).radiance[0];
  EXPECT_NEAR(on, 6.1f, 0.01f);
  EXPECT_NEAR(beside, 6.1f, 0.1f);
}

TEST(MovingLeastSquares, AreNeverNegativeAndKnownWhereARayIsNear) {
  const FieldGrid grid{{9, 9, 9}, Vec3d::Zero(), Vec3d::Constant(8)};
  const ShearPlane plane(grid, Vec3d::UnitZ(), 1);
  std::vector<PlaneSample> samples;
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) {
      const Eigen::Vector2f at(static_cast<float>(i), static_cast<float>(j));
      samples.push_back({at, Eigen::Array3f::Constant(i < 2 ? 0.0f : 100.0f)});
    }
  NearestSamples nearest;
  nearest.build(samples);
  PlaneImage image;
  MovingLeastSquares().fit(plane, nearest, 9, image);
  for (std::size_t i = 0; i < 3 * image.pixels(); ++i) EXPECT_GE(image.channels[i], 0);
  const auto known = [&](int x, int y) { return image.channel(3)[y * image.width + x]; };
  EXPECT_EQ(known(4, 5), 1);  // a cell from the last ray
  EXPECT_EQ(known(4, 6), 0);  // two
}

TEST(SupportChoice, IsFewForAnEdgeAndManyForNoise) {
  std::mt19937 random(9);
  std::normal_distribution<float> noise(1, 0.3f);
  SupportChoice edge, noisy;
  NearestSamples nearest;
  const auto step = scattered(600, [](const Eigen::Vector2f& at) -> Eigen::Array3f {
    return Eigen::Array3f::Constant(at.x() < 5 ? 10.0f : 0.0f);
  });
  nearest.build(step);
  edge.add(nearest);
  const auto rough =
      scattered(600, [&](const Eigen::Vector2f&) { return Eigen::Array3f(noise(random), 1, 1); });
  nearest.build(rough);
  noisy.add(nearest);
  EXPECT_LT(edge.best(), noisy.best());
  EXPECT_GE(noisy.best(), 28);
  // .3 of noise in one of three channels of about 1: .3 / √3, and a little for the mean of forty.
  EXPECT_NEAR(noisy.held_out_error(), 0.3 / std::sqrt(3), 0.03);
}

// A picture that was taken twice foretells itself, which says nothing of places between pictures.
TEST(SupportChoice, ForetellsFromOtherPlaces) {
  std::mt19937 random(9);
  std::normal_distribution<float> noise(1, 0.3f);
  const auto once =
      scattered(300, [&](const Eigen::Vector2f&) { return Eigen::Array3f(noise(random), 1, 1); });
  const auto error_of_copies = [&](int copies) {
    std::vector<PlaneSample> samples;
    for (int copy = 0; copy < copies; ++copy)
      for (PlaneSample sample : once) {
        sample.at.x() += 0.004f * static_cast<float>(copy % 2);  // as a tracker trembles
        samples.push_back(sample);
      }
    NearestSamples nearest;
    nearest.build(samples);
    SupportChoice choice;
    choice.add(nearest);
    return choice.held_out_error();
  };
  // .3 of noise in one of three channels of about 1: .3 / √3 at least, whatever is foretold from.
  for (const int copies : {1, 2, 5, 50})
    EXPECT_GT(error_of_copies(copies), 0.95 * 0.3 / std::sqrt(3)) << copies;
}

TEST(SupportChoice, OfOnePlaceForetellsNothing) {
  for (const std::size_t count : {1u, 7u, 200u}) {
    const std::vector<PlaneSample> samples(count, {{1, 2}, {3, 4, 5}});
    NearestSamples nearest;
    nearest.build(samples);
    SupportChoice choice;
    choice.add(nearest);
    EXPECT_TRUE(std::isnan(choice.held_out_error())) << count;
    EXPECT_EQ(choice.best(), 13);
    EXPECT_FALSE(foretell(nearest, 0, 4).has_value());
  }
}

// Among copies a ray's fit is what it is without them.
TEST(MovingLeastSquares, OfAHeldOutRayLeaveOutItsWholePlace) {
  const auto once = scattered(60, plane_of_light);
  std::vector<PlaneSample> samples = once;
  samples.insert(samples.end(), 100, samples[20]);
  NearestSamples alone, among;
  alone.build(once);
  among.build(samples);
  for (const int support : {4, 13, 40}) {
    const auto expected = foretell(alone, 20, support), found = foretell(among, 20, support);
    ASSERT_TRUE(expected && found);
    EXPECT_GT(found->nearest_cells, kOnePlace_cells);
    EXPECT_LT((found->radiance - expected->radiance).abs().maxCoeff(), 1e-5f) << support;
  }
}

TEST(SupportChoice, OfDarknessIsTheMiddle) {
  SupportChoice choice;
  NearestSamples nearest;
  const auto dark = scattered(50, [](const Eigen::Vector2f&) { return Eigen::Array3f(0, 0, 0); });
  nearest.build(dark);
  choice.add(nearest);
  EXPECT_EQ(choice.best(), 13);
  EXPECT_EQ(choice.held_out_error(), 0);
}

}  // namespace
}  // namespace lightwell
