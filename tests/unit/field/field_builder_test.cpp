// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "field/field_builder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "tests/support/analytic_fields.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

// Latitude–longitude pictures of a field, made when they are asked for.
ProbeTake take_of(const test::AnalyticField& field, std::vector<Vec3d> positions, int height) {
  ProbeTake take;
  take.positions = std::move(positions);
  take.name = [](std::size_t i) { return "probe_" + std::to_string(i) + ".exr"; };
  take.picture = [field, height, places = take.positions](std::size_t i) -> Result<LatLongImage> {
    LatLongImage image{2 * height, height, {}};
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < 2 * height; ++x)
        image.pixels.push_back(
            field(places[i], direction_from_lat_long((x + 0.5) / (2 * height), (y + 0.5) / height))
                .cast<float>());
    return image;
  };
  return take;
}

class FieldBuilder : public testing::Test {
 protected:
  FieldBuilder() {
    options_.grid = {{6, 5, 4}, Vec3d::Zero(), Vec3d::Ones()};
    options_.directions = 300;
    options_.scratch_folder = folder_.path();
  }
  test::TemporaryFolder folder_;
  FieldBuildOptions options_;
};

TEST_F(FieldBuilder, IsTheSameToTheLastBitForAnyNumberOfThreads) {
  const ProbeTake take = take_of(test::box_of_lamps, test::random_positions(40, 1), 12);
  for (const FieldMethod method : {FieldMethod::best, FieldMethod::low}) {
    options_.method = method;
    options_.threads = 1;
    const auto one = build_field(take, options_);
    options_.threads = 5;
    const auto five = build_field(take, options_);
    ASSERT_TRUE(one && five);
    EXPECT_EQ(one->field.radiance, five->field.radiance);
    EXPECT_EQ(one->field.confidence, five->field.confidence);
    EXPECT_EQ(one->held_out_error, five->held_out_error);
  }
}

// Through pictures, buckets on disk and batches: what the field's own mathematics gives, to what a picture of 15° a pixel
// makes of it.
TEST_F(FieldBuilder, KeepsAFieldThroughPicturesAndBuckets) {
  options_.degree = 2;
  options_.directions = 500;
  options_.grid.size = {4, 4, 4};
  const auto build =
      build_field(take_of(test::linear_field, test::random_positions(100, 2, 0.1), 24), options_);
  ASSERT_TRUE(build);
  EXPECT_LT(test::harmonics_error(build->field, test::linear_field, 20, 3000), 0.01);
  EXPECT_NEAR(build->coverage, 1, 1e-3);
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(FieldBuilder, OneProbeIsTheSameEverywhereAndKnownOnlyAlongItsRays) {
  const auto build = build_field(take_of(test::box_of_lamps, {Vec3d(0.5, 0.5, 0.5)}, 24), options_);
  ASSERT_TRUE(build);
  const LightAtPoint a = light_at(build->field, Vec3d::Zero()),
                     b = light_at(build->field, Vec3d(0.9, 0.2, 0.7));
  EXPECT_LT((a.radiance - b.radiance).abs().maxCoeff(), 1e-4);
  EXPECT_GT(a.radiance(0, 0), 1);
  EXPECT_LT(a.confidence, 0.5);
  EXPECT_GT(light_at(build->field, Vec3d(0.5, 0.5, 0.5)).confidence, 0.99);
}

// What the projection could show and no picture has, as of a fisheye's walk, is no part of what was seen.
TEST_F(FieldBuilder, CountsWhatIsInThePicturesNotWhatCouldBe) {
  ProbeTake take = take_of(test::linear_field, test::random_positions(9, 3), 24);
  const auto whole = take.picture;
  take.picture = [whole](std::size_t i) {
    auto picture = whole(i);
    for (std::size_t p = 0; p < picture->pixels.size(); ++p)
      if (p >= picture->pixels.size() / 2 || i % 2 == 0)  // below the horizon, and all of every other picture
        picture->pixels[p].setConstant(std::numeric_limits<float>::quiet_NaN());
    return picture;
  };
  const auto build = build_field(take, options_);
  ASSERT_TRUE(build);
  // The horizon's cells, a row of 300 of the sphere, are seen by halves.
  EXPECT_NEAR(build->coverage, 0.5, 0.06);
  EXPECT_NEAR(build->directions, 150, 18);
}

TEST_F(FieldBuilder, DarknessIsAFieldOfNoLight) {
  const auto dark = [](const Vec3d&, const Vec3d&) -> Rgbd { return {0, 0, 0}; };
  const auto build = build_field(take_of(dark, test::random_positions(9, 3), 8), options_);
  ASSERT_TRUE(build);
  for (const float value : build->field.radiance) EXPECT_EQ(value, 0);
  EXPECT_EQ(build->held_out_error, 0);
}

TEST_F(FieldBuilder, RefusesPicturesOfAnotherSizeAndNamesBoth) {
  ProbeTake take = take_of(test::linear_field, test::random_positions(5, 3), 8);
  const auto even = take.picture;
  take.picture = [even](std::size_t i) -> Result<LatLongImage> {
    if (i == 3) return LatLongImage{3, 2, std::vector<Rgb>(6, Rgb(1, 1, 1))};
    return even(i);
  };
  options_.threads = 3;
  const auto build = build_field(take, options_);
  ASSERT_FALSE(build);
  EXPECT_EQ(build.error().kind, ErrorKind::bad_input);
  EXPECT_EQ(build.error().message, "probe_3.exr: is 3x2 pixels, allowed 16x8, the size of probe_0.exr");
}

TEST_F(FieldBuilder, SaysWhereItCannotSort) {
  options_.scratch_folder = folder_.path() / "absent";
  const auto build = build_field(take_of(test::linear_field, test::random_positions(2, 3), 8), options_);
  ASSERT_FALSE(build);
  EXPECT_EQ(build.error().kind, ErrorKind::failed);
  EXPECT_THAT(build.error().message, testing::HasSubstr("absent: cannot write"));
}

}  // namespace
}  // namespace lightwell
