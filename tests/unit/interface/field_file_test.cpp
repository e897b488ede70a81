// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/field_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>

#include "interface/atomic_file.h"
#include "lighting/field/field_sparsity.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

// Smooth in one half of the grid, with an edge in the other.
LightField stage(std::array<int, 3> size, double brightness) {
  LightField field;
  field.grid = {size, Vec3d(-1, 0, 2), Vec3d(3, 1, 4)};
  field.degree = 2;
  field.radiance.resize(field.grid.points() * 27);
  field.confidence.assign(field.grid.points(), 0.75f);
  for (int k = 0; k < size[2]; ++k)
    for (int h = 0; h < 9; ++h)
      for (int c = 0; c < 3; ++c)
        for (int j = 0; j < size[1]; ++j)
          for (int i = 0; i < size[0]; ++i) {
            const double x = static_cast<double>(i) / size[0];
            const double value =
                x < 0.5 ? 1 + 0.5 * x + 0.1 * k + 0.2 * h : (j * 2 > size[1] ? 3 : 0.2 * (c + 1));
            field.plane(k, h, c)[j * size[0] + i] = static_cast<float>(brightness * value);
          }
  return field;
}

class FieldFileTest : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }
  test::TemporaryFolder folder_;
};

TEST_F(FieldFileTest, ComesBackToHalfFloatsWhateverItsBrightness) {
  for (const double brightness : {1.0, 1e9, 1e-9}) {
    const LightField field = stage({9, 5, 6}, brightness);
    const auto report = write_field(path("f.vdb"), field, {"low", 0});
    ASSERT_TRUE(report);
    EXPECT_EQ(report->stored_points, field.grid.points());
    const auto back = read_field(path("f.vdb"));
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->method, "low");
    EXPECT_EQ(back->field.degree, 2);
    EXPECT_EQ(back->field.grid.size, field.grid.size);
    EXPECT_EQ(back->field.grid.low, field.grid.low);
    EXPECT_EQ(back->field.grid.high, field.grid.high);
    for (std::size_t i = 0; i < field.radiance.size(); ++i)
      ASSERT_NEAR(back->field.radiance[i], field.radiance[i], std::abs(field.radiance[i]) / 2048);  // 11 bits
    EXPECT_EQ(back->field.confidence, field.confidence);
    EXPECT_GT(report->rms_error, 0);
    EXPECT_LT(report->rms_error, 1.0 / 2048);
  }
}

TEST_F(FieldFileTest, LeavesOutWhatCoarserPointsForetellWithinTheBound) {
  const LightField field = stage({17, 9, 12}, 1);
  const auto sparse = write_field(path("sparse.vdb"), field, {"best", 0.02});
  ASSERT_TRUE(sparse);
  EXPECT_LT(sparse->stored_points, field.grid.points() / 2);
  const double half_float =
      1.0 / 2048 * 4;  // of the brightest point, twice the RMS, through an interpolation
  EXPECT_LT(sparse->most_error, 0.02 + half_float);
  // The report is what a reader finds.
  const auto back = read_field(path("sparse.vdb"));
  ASSERT_TRUE(back);
  double error = 0, square = 0;
  for (std::size_t i = 0; i < field.radiance.size(); ++i) {
    error += std::pow(static_cast<double>(back->field.radiance[i] - field.radiance[i]), 2);
    square += std::pow(static_cast<double>(field.radiance[i]), 2);
  }
  EXPECT_NEAR(std::sqrt(error / square), sparse->rms_error, 1e-6);
  EXPECT_EQ(back->max_error, 0.02);
}

TEST(FieldSparsity, ALinearFieldNeedsItsCoarsestPointsAlone) {
  LightField field;
  field.grid = {{9, 6, 7}, Vec3d::Zero(), Vec3d::Ones()};
  field.degree = 1;
  field.radiance.resize(field.grid.points() * 12);
  field.confidence.assign(field.grid.points(), 1);
  for (int k = 0; k < 7; ++k)
    for (int h = 0; h < 12; ++h)
      for (int j = 0; j < 6; ++j)
        for (int i = 0; i < 9; ++i)
          field.plane(k, h / 3, h % 3)[j * 9 + i] = static_cast<float>(1 + i + 2 * j - k + h);
  const auto stored = stored_points(field, 1e-5);
  EXPECT_EQ(std::count(stored.begin(), stored.end(), 1), 8);  // its corners
  LightField filled = field;
  for (int k = 0; k < 7; ++k)
    for (int h = 0; h < 12; ++h)
      for (int i = 0; i < 54; ++i)
        if (stored[static_cast<std::size_t>(k * 54 + i)] == 0) filled.plane(k, h / 3, h % 3)[i] = -1000;
  fill_left_out(filled, stored);
  for (std::size_t i = 0; i < field.radiance.size(); ++i)
    EXPECT_NEAR(filled.radiance[i], field.radiance[i], 1e-4);
}

TEST_F(FieldFileTest, RefusesWhatIsNoWholeFieldInOneLine) {
  ASSERT_TRUE(write_field(path("good.vdb"), stage({8, 8, 8}, 1), {}));
  const auto bytes = read_text_file(path("good.vdb"));
  ASSERT_TRUE(bytes);
  const auto refused = [&](const std::string& content) {
    std::ofstream(path("bad.vdb"), std::ios::binary) << content;
    const auto read = read_field(path("bad.vdb"));
    EXPECT_FALSE(read);
    if (read) return std::string();
    EXPECT_EQ(read.error().kind, ErrorKind::bad_input);
    EXPECT_THAT(read.error().message, testing::HasSubstr("bad.vdb: "));
    EXPECT_EQ(read.error().message.find('\n'), std::string::npos);
    return read.error().message;
  };
  refused("");
  refused("x,y,z,file\n");
  for (const std::size_t part : {20u, 200u, 1000u, 5000u}) refused(bytes->substr(0, part));
  refused(bytes->substr(0, bytes->size() - 100));
  std::string other = *bytes;
  other.replace(other.find("lightwell.field/1"), 17, "lightwell.field/9");
  EXPECT_THAT(refused(other),
              testing::HasSubstr("lightwell_schema = lightwell.field/9: allowed lightwell.field/1"));
  // The size that a build refuses, too.
  const std::array<std::int32_t, 3> size = {8, 8, 8}, beyond = {512, 512, 513};
  const auto text = [](const std::array<std::int32_t, 3>& numbers) {
    return std::string(reinterpret_cast<const char*>(numbers.data()), sizeof numbers);
  };
  other = *bytes;
  other.replace(other.find(text(size), other.find("lightwell_size")), sizeof size, text(beyond));
  EXPECT_THAT(refused(other),
              testing::HasSubstr("lightwell_size: points = 134479872: allowed up to 512 cubed"));
  EXPECT_THAT(read_field(path("absent.vdb")).error().message,
              testing::HasSubstr("absent.vdb: cannot read: No such file"));
  EXPECT_FALSE(read_field(folder_.path()));
}

// OpenVDB itself reads most of it, and an instrumented program cannot outlive the sizes that damage makes it ask for: so
// here rather than under tests/fuzz.
TEST_F(FieldFileTest, OutlivesDamageAnywhere) {
  ASSERT_TRUE(write_field(path("f.vdb"), stage({5, 4, 3}, 1), {"best", 0.01}));
  const std::string good = *read_text_file(path("f.vdb"));
  std::mt19937 random(11);
  int refused = 0;
  constexpr int kTrials = 200;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::string damaged = good;
    for (int flips = 1 + trial % 3; flips > 0; --flips)
      damaged[random() % damaged.size()] = static_cast<char>(random() % 256);
    if (trial % 4 == 0) damaged.resize(random() % damaged.size());
    std::ofstream(path("d.vdb"), std::ios::binary) << damaged;
    const auto field = read_field(path("d.vdb"));
    if (!field) {
      EXPECT_EQ(field.error().message.find('\n'), std::string::npos) << field.error().message;
      ++refused;
      continue;
    }
    ASSERT_EQ(field->field.confidence.size(), field->field.grid.points());
    ASSERT_EQ(field->field.radiance.size(),
              field->field.grid.points() * 3 * static_cast<std::size_t>(field->field.harmonics()));
    for (const float value : field->field.radiance) ASSERT_TRUE(std::isfinite(value)) << trial;
    for (const float value : field->field.confidence) ASSERT_TRUE(value >= 0 && value <= 1) << trial;
  }
  EXPECT_GT(refused, kTrials / 4);
}

}  // namespace
}  // namespace lightwell
