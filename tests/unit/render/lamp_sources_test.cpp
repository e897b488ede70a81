// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/lamp_sources.h"

#include <gtest/gtest.h>

#include <array>

#include "render/lamp_detail.h"
#include "tests/support/lamp_reference.h"

namespace lightwell::render {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

// Light of a plane's pixels, weighted alike: tangents are evenly spaced in all images.
Rgbd sum_of(const std::vector<Rgb>& pixels) {
  Rgbd sum = Rgbd::Zero();
  for (const Rgb& p : pixels) sum += p.cast<double>();
  return sum;
}

TEST(LampSources, PositionAloneKeepsItsPixels) {
  const NearField lamp = patterned_lamp(3, 2, 0.02, 16);
  const LampSources sources = sources_of(lamp, 1);
  ASSERT_EQ(sources.sources.size(), 6u);
  EXPECT_EQ(sources.pixels.size(), lamp.intensity.values.size());
  for (std::size_t i = 0; i < sources.pixels.size(); ++i)
    ASSERT_TRUE((sources.pixels[i] == lamp.intensity.values[i]).all());
  // From the first position the image begins at this tangent.
  const LampPlanes& planes = lamp.intensity.planes;
  EXPECT_TRUE(sources.sources[0].low.isApprox((planes.low_m - planes.position(0, 0)) / planes.distance_m));
}

TEST(LampSources, PositionsTakenTogetherLoseNoLight) {
  const NearField lamp = patterned_lamp(9, 7, 0.017, 24);  // a spacing is no whole number of pixels
  const Rgbd all = sum_of(lamp.intensity.values);
  for (const int group : {2, 3, 5, 9}) {
    const LampSources sources = sources_of(lamp, group);
    EXPECT_EQ(sources.sources.size(), source_count(lamp, group));
    EXPECT_LE((sum_of(sources.pixels) - all).abs().maxCoeff(), 1e-5 * all.maxCoeff()) << group;
  }
  EXPECT_EQ(sources_of(lamp, largest_group(lamp)).sources.size(), 1u);
}

TEST(LampSources, PositionsWithoutLightAreLeftOut) {
  NearField lamp = patterned_lamp(3, 3, 0.02, 8);
  std::fill_n(lamp.intensity.image(1, 1), lamp.intensity.planes.image_size(), Rgb::Zero());
  EXPECT_EQ(sources_of(lamp, 1).sources.size(), 8u);
  EXPECT_EQ(sources_of(lamp, 3).sources.size(), 1u);
}

TEST(LampSources, FarFieldHasTheTablesNodes) {
  FarField far;
  far.horizontal_deg = {0, 90, 180, 270};
  far.vertical_deg = {0, 45, 90, 135, 180};
  for (int i = 0; i < 20; ++i) far.candela.push_back(i);
  const LampSources sources = sources_of(far, Vec3d::Zero());
  // Steps of 45° both ways: a column between two planes is the middle of them.
  ASSERT_EQ(sources.width, 8);
  ASSERT_EQ(sources.height, 5);
  for (int v = 0; v < 5; ++v)
    for (int h = 0; h < 4; ++h) {
      const auto at = [&](int plane) {
        return static_cast<float>(far.at(static_cast<std::size_t>(plane % 4), static_cast<std::size_t>(v)));
      };
      const auto pixel = [&](int column) {
        return sources.pixels[static_cast<std::size_t>(v * 8 + column)][0];
      };
      EXPECT_EQ(pixel(2 * h), at(h));
      EXPECT_FLOAT_EQ(pixel(2 * h + 1), (at(h) + at(h + 1)) / 2);
    }
}

TEST(LampSources, FarFieldHasStepsAsWideAsHigh) {
  const auto nodes = [](double across, double along) {
    FarField far;
    far.horizontal_deg.clear();
    for (int i = 0; i * across < 360; ++i) far.horizontal_deg.push_back(i * across);
    for (int i = 0; i * along <= 180; ++i) far.vertical_deg.push_back(i * along);
    far.candela.assign(far.horizontal_deg.size() * far.vertical_deg.size(), 1);
    const LampSources sources = sources_of(far, Vec3d::Zero());
    return std::array<int, 2>{sources.width, sources.height};
  };
  EXPECT_EQ(nodes(15, 1), (std::array<int, 2>{360, 181}));
  EXPECT_EQ(nodes(2.5, 30), (std::array<int, 2>{144, 73}));
  EXPECT_EQ(nodes(5, 2), (std::array<int, 2>{216, 91}));   // 5/3° and 2°
  EXPECT_EQ(nodes(360, 1), (std::array<int, 2>{1, 181}));  // the same all around
  EXPECT_LE(nodes(90, 0.1)[0], 4096);                      // of textures that drivers hold
}

TEST(LampSources, FarFieldThatEndsBrightEndsSharply) {
  FarField half;  // nothing above the horizon
  half.vertical_deg = {0, 45, 90};
  half.candela = {10, 10, 10};
  const LampSources sources = sources_of(half, Vec3d::Zero());
  const double step = 180.0 / (sources.height - 1);
  EXPECT_LE(step, 0.5);
  EXPECT_EQ(sources.pixels[static_cast<std::size_t>(std::lround(90 / step) * sources.width)][0], 10);
  EXPECT_EQ(sources.pixels[static_cast<std::size_t>((std::lround(90 / step) + 1) * sources.width)][0], 0);
}

class Detail : public ::testing::Test {
 protected:
  void SetUp() override {
    add_ground(scene_, lambertian(Rgb::Constant(0.5f)), false, 1);
    add_box(scene_, {-0.1f, 0, -0.1f}, {0.1f, 0.2f, 0.1f}, lambertian(Rgb::Constant(0.5f)));
    receivers_ = Receivers(scene_);
    casters_ = find_casters(scene_);
  }
  [[nodiscard]] LampDetail::Error error_at(double height_m, int group) const {
    const auto pose = aimed_down({0, height_m, 0});
    const auto outlines = CasterOutlines(casters_).seen_from(lamp_eye(lamp_, pose), casters_);
    return detail_.error(lamp_, group, {receivers_.places(), outlines}, pose);
  }
  [[nodiscard]] int group_at(double height_m, double bound, int now = 0) const {
    const auto pose = aimed_down({0, height_m, 0});
    const auto outlines = CasterOutlines(casters_).seen_from(lamp_eye(lamp_, pose), casters_);
    return detail_.choose(lamp_, bound, {receivers_.places(), outlines}, pose, 1, now);
  }
  Scene scene_;
  Receivers receivers_;
  NearField lamp_ = patterned_lamp(9, 7, 0.005, 24, 0.1, 0.1);
  LampDetail detail_{lamp_};
  Casters casters_;
};

TEST_F(Detail, FewerPointsServeFartherAwayDownToOne) {
  int last = 1;
  for (const double height : {0.4, 1.0, 3.0, 10.0, 100.0}) {
    const int group = group_at(height, 0.02);
    EXPECT_GE(group, last) << height;
    last = group;
  }
  EXPECT_EQ(last, largest_group(lamp_));
  EXPECT_EQ(group_at(0.4, 0), 1);
}

TEST_F(Detail, WhatIsChosenErrsByNoMoreThanIsAllowed) {
  for (const double height : {0.5, 2.0, 8.0}) {
    const int group = group_at(height, 0.02);
    EXPECT_LE(error_at(height, group).total(), 0.02) << height;
  }
  EXPECT_LT(error_at(0.5, 1).total(), 1e-12);  // the rounding of the middles
}

TEST_F(Detail, GroupThatIsDrawnStaysWhileItServes) {
  // Just within the bound from one side: from the other it waits for half of it.
  const double bound = 1.2 * error_at(20, 9).total();
  EXPECT_EQ(group_at(20, bound, 0), 9);
  EXPECT_EQ(group_at(20, bound, 9), 9);
  EXPECT_LT(group_at(20, bound, 3), 9);
}

TEST_F(Detail, LampOfManyPositionsIsLookedAtFromFewerPlacesThatSayTheSame) {
  EXPECT_EQ(places_looked_at(256, 63), 256u);
  EXPECT_EQ(places_looked_at(2048, 1089), 64u);
  EXPECT_EQ(places_looked_at(10, 1089), 10u);
  // Of the ground's and the box's places a quarter.
  lamp_ = patterned_lamp(23, 23, 0.002, 12, 0.1, 0.1);
  detail_ = LampDetail(lamp_);
  ASSERT_LT(places_looked_at(256, 23 * 23), 70u);
  const double few = error_at(0.5, 8).pattern;
  // A lamp as large of a quarter of the positions, looked at from all places, has the same pattern.
  lamp_ = patterned_lamp(11, 11, 0.0042, 12, 0.1, 0.1);
  detail_ = LampDetail(lamp_);
  ASSERT_EQ(places_looked_at(256, 11 * 11), 256u);
  EXPECT_NEAR(few / error_at(0.5, 4).pattern, 1, 0.3);
}

TEST(CasterOutline, BallHasACircleAndAFlagItsBorder) {
  Scene scene;
  add_sphere(scene, {0, 0, 0}, 0.5f, lambertian(Rgb::Constant(0.5f)));
  add_mesh(scene, {{-0.1f, 1, -0.2f}, {0.1f, 1, -0.2f}, {0.1f, 1, 0.2f}, {-0.1f, 1, 0.2f}}, {},
           {0, 1, 2, 0, 2, 3}, lambertian(Rgb::Constant(0.5f)));
  const Casters casters = find_casters(scene);
  const auto outlines = CasterOutlines(casters).seen_from({0, 20, 0}, casters);
  ASSERT_EQ(outlines.size(), 2u);
  for (const CasterOutline& outline : outlines) {
    const bool ball = outline.primitive == 0;
    // From afar angles are lengths over the distance; a ball's edges run to and fro about the circle.
    const double distance = ball ? 20 : 19, length = ball ? kPi : 1.2;
    EXPECT_NEAR(outline.length_rad * distance / length, 1, ball ? 0.1 : 0.001);
    EXPECT_NEAR(outline.rad_per_m / outline.length_rad * distance, 1, 0.01);
    EXPECT_NEAR(outline.half_angle_rad * distance, ball ? 0.5 : std::sqrt(0.05), 0.01);
  }
}

}  // namespace
}  // namespace lightwell::render
