// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "field/walk_take.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "interface/calibration_io.h"
#include "interface/pose_file.h"
#include "interface/recording.h"
#include "tests/support/analytic_fields.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr FrameFormat kFormat{160, 160, PixelFormat::mono16};
constexpr std::int64_t kFirst_ns = 5'000'000'000, kPeriod_ns = 20'000'000;
constexpr double kLag_s = 0.03;

// A linear sensor of 16 bits behind a fisheye of 180°.
Calibration calibration() {
  Calibration c;
  c.response.model = LinearResponse{100, 15000};
  c.response.bits = 16;
  c.response.black_code = 100;
  c.response.clip_code = 65000;
  c.response.reference_exposure_us = 1000;
  c.lens.image_size = {kFormat.width, kFormat.height};
  c.lens.focal = {50, 50};
  c.lens.center = {79.5, 79.5};
  c.id = calibration_id(c);
  return c;
}

// On its way through the unit cube, 0 to 1: a curve that fills it.
Vec3d place(double part) {
  return Vec3d::Constant(0.5) + 0.45 * Vec3d(std::sin(2 * kPi * 3 * part), std::sin(2 * kPi * 5 * part + 1),
                                             std::sin(2 * kPi * 7 * part + 2));
}

class WalkTakeTest : public testing::Test {
 protected:
  // Frames of a field, seen by a probe that is turned so all the way; poses at 100 Hz, late by kLag_s.
  void walk(const test::AnalyticField& field, int frames, const Eigen::Quaterniond& turn, float bright = 1) {
    const Calibration camera = calibration();
    RecordingHeader header;
    header.format = kFormat;
    header.rate_hz = 50;
    header.source = "test";
    header.calibration_json = calibration_to_json(camera);
    auto writer = RecordingWriter::create(take(), header);
    ASSERT_TRUE(writer.ok()) << writer.error().message;
    for (int i = 0; i < frames; ++i) {
      RecordedFrame frame;
      frame.sequence = static_cast<std::uint64_t>(i);
      frame.capture_mono_ns = kFirst_ns + i * kPeriod_ns;
      frame.exposure_us = 1000;
      const Vec3d at = place(static_cast<double>(i) / frames);
      std::vector<std::uint16_t> codes;
      for (int y = 0; y < kFormat.height; ++y)
        for (int x = 0; x < kFormat.width; ++x) {
          const Vec3d direction = turn * world_from_camera(camera.lens.unproject(Vec2d(x, y)));
          const double light = luminance(field(at, direction)) * static_cast<double>(bright);
          codes.push_back(
              static_cast<std::uint16_t>(std::min(65535.0, std::round(camera.response.code(light)))));
        }
      const Status written = (*writer)->write(frame, std::as_bytes(std::span(codes)));
      ASSERT_TRUE(written.ok());
    }
    ASSERT_TRUE((*writer)->close().ok());
    auto poses = PoseFileWriter::create(poses_beside(take()), false);
    ASSERT_TRUE(poses.ok());
    for (std::int64_t t = -100'000'000; t <= frames * kPeriod_ns + 100'000'000; t += 1'000'000)
      ASSERT_TRUE(
          poses
              ->write({kFirst_ns + t + std::llround(kLag_s * 1e9),
                       {place(static_cast<double>(t) / static_cast<double>(kPeriod_ns) / frames), turn}})
              .ok());
    ASSERT_TRUE(poses->keep().ok());
  }
  [[nodiscard]] std::filesystem::path take() const { return folder_.path() / "walk.mkv"; }
  [[nodiscard]] std::filesystem::path poses() const { return folder_.path() / "some.csv"; }
  [[nodiscard]] std::string take_name() const { return take().string(); }
  [[nodiscard]] WalkOptions options() const {
    WalkOptions o;
    o.take = take();
    o.lag_s = kLag_s;
    o.redundant.most_difference = 0;
    return o;
  }
  [[nodiscard]] static std::shared_ptr<WalkTake> opened(const WalkOptions& o) {
    auto walk = WalkTake::open(o);
    EXPECT_TRUE(walk.ok()) << (walk.ok() ? "" : walk.error().message);
    return walk.ok() ? *walk : nullptr;
  }
  [[nodiscard]] FieldBuildOptions build_options(const WalkTake& walk) const {
    FieldBuildOptions o;
    o.grid = {{5, 5, 5}, Vec3d::Constant(0.1), Vec3d::Constant(0.9)};
    o.degree = 3;
    o.directions = 800;
    o.projection = walk.projection();
    o.scratch_folder = folder_.path();
    o.threads = 3;
    return o;
  }
  // Relative RMS error of harmonics between grid points against the field's own, where the probe looked.
  [[nodiscard]] double field_error(const LightField& field, const test::AnalyticField& truth,
                                   const Eigen::Quaterniond& turn) const {
    const test::AnalyticField seen = [&](const Vec3d& at, const Vec3d& toward) -> Rgbd {
      if ((turn.conjugate() * toward).y() < 0) return Rgbd::Zero();
      return Rgbd::Constant(luminance(truth(at, toward)));
    };
    double square_error = 0, square = 0;
    for (const Vec3d& at : test::random_positions(10, 4, -0.2)) {
      const Eigen::MatrixXd exact = test::exact_harmonics(seen, at, 3, 40000);
      const LightAtPoint found = light_at(field, at);
      square_error += (found.radiance.matrix() - exact).squaredNorm();
      square += exact.squaredNorm();
    }
    return std::sqrt(square_error / square);
  }
  test::TemporaryFolder folder_;
};

TEST_F(WalkTakeTest, AWalkThroughALinearFieldGivesThatField) {
  const Eigen::Quaterniond upright = Eigen::Quaterniond::Identity();
  walk(test::linear_field, 250, upright);
  const auto take = opened(options());
  ASSERT_TRUE(take);
  EXPECT_EQ(take->counts().frames, 250u);
  EXPECT_EQ(take->counts().kept, 250u);
  EXPECT_THAT(take->remarks(), ElementsAre());
  const auto built = build_field(WalkTake::probes(take), build_options(*take));
  ASSERT_TRUE(built.ok()) << built.error().message;
  EXPECT_NEAR(built->coverage, 0.5, 1e-3) << "nothing below the horizon";
  EXPECT_LT(field_error(built->field, test::linear_field, upright), 0.01);
  // With poses taken for punctual the places are wrong.
  WalkOptions punctual = options();
  punctual.lag_s = 0.2;
  const auto late = opened(punctual);
  const auto wrong = build_field(WalkTake::probes(late), build_options(*late));
  ASSERT_TRUE(wrong.ok());
  EXPECT_GT(wrong->held_out_error, 3 * built->held_out_error);
}

TEST_F(WalkTakeTest, ATurnedProbeMeasuresTheSameWorld) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.1, Vec3d::UnitY()) *
                                Eigen::AngleAxisd(0.6, Vec3d::UnitX()));
  walk(test::linear_field, 250, turn);
  const auto take = opened(options());
  ASSERT_TRUE(take);
  EXPECT_NEAR(take->projection().theta_max_rad, kPi / 2 + 0.6, 1e-6);
  FieldBuildOptions fine = build_options(*take);
  fine.directions = 3000;
  const auto built = build_field(WalkTake::probes(take), fine);
  ASSERT_TRUE(built.ok()) << built.error().message;
  // At the slanted horizon a cell of 4° counts wholly or not at all.
  EXPECT_LT(field_error(built->field, test::linear_field, turn), 0.03);
  for (const float confidence : built->field.confidence) EXPECT_LT(confidence, 0.55f);
}

TEST_F(WalkTakeTest, PicturesAreTheSameInAnyOrder) {
  walk(test::linear_field, 60, Eigen::Quaterniond::Identity());
  const auto take = opened(options());
  ASSERT_TRUE(take);
  const ProbeTake probes = WalkTake::probes(take);
  ASSERT_EQ(probes.positions.size(), 60u);
  EXPECT_LE((probes.positions[30] - place(0.5)).norm(), 1e-3);
  EXPECT_EQ(probes.name(30), take_name() + ": frame 30");
  std::vector<LatLongImage> in_order;
  for (std::size_t i = 0; i < 60; ++i) in_order.push_back(*probes.picture(i));
  for (const std::size_t i : {59u, 3u, 2u, 45u, 44u, 0u, 59u}) {
    const auto again = probes.picture(i);
    ASSERT_TRUE(again.ok()) << again.error().message;
    EXPECT_EQ(
        std::memcmp(again->pixels.data(), in_order[i].pixels.data(), again->pixels.size() * sizeof(Rgb)), 0)
        << i;
  }
}

TEST_F(WalkTakeTest, FramesWithoutAPoseAreCountedAndSaid) {
  walk(test::linear_field, 50, Eigen::Quaterniond::Identity());
  std::ofstream(poses()) << "time_ns,x,y,z\n"
                         << kFirst_ns + 10 * kPeriod_ns << ",0,0,0\n"
                         << kFirst_ns + 14 * kPeriod_ns << ",0.1,0,0\n"
                         << kFirst_ns + 20 * kPeriod_ns << ",0.1,0,0\n"
                         << kFirst_ns + 22 * kPeriod_ns << ",9,0,0\n"
                         << kFirst_ns + 25 * kPeriod_ns << ",9,0,0\n";
  WalkOptions o = options();
  o.poses = poses();
  o.lag_s = 0;
  const auto take = opened(o);
  ASSERT_TRUE(take);
  const WalkCounts& counts = take->counts();
  EXPECT_EQ(counts.outside, 34u) << "0 to 9, 26 to 49";
  EXPECT_EQ(counts.in_gap, 5u) << "15 to 19: 120 ms";
  EXPECT_EQ(counts.in_jump, 1u);
  EXPECT_EQ(counts.kept, 10u);
  EXPECT_THAT(
      take->remarks(),
      ElementsAre(
          take_name() +
              ": 40 of 50 frames have no pose and are left out: 10 before the first, 24 after "
              "the last, 5 in gaps above 0.1 s, 1 in jumps; of the take: 0.000 to 0.180 s (10 frames), "
              "0.300 to 0.380 s (5 frames), 0.420 s (1 frame), 0.520 to 0.980 s (24 frames)",
          poses().string() + ": line 5 is 8.9 m and 0 degrees from line 4, 0.04 s earlier: allowed up "
                             "to 20 m/s and 720 degrees/s; frames between are left out"));
  EXPECT_EQ(take->without_pose().spans().back().frames, 24u);
  o.lag_s = 100;
  const auto none = WalkTake::open(o);
  ASSERT_FALSE(none.ok());
  EXPECT_EQ(none.error().kind, ErrorKind::bad_input);
  EXPECT_EQ(none.error().message,
            poses().string() + ": no frame of " + take_name() +
                " has a pose: frames are from 5.000 s to 5.980 s, poses from 5.200 s to 5.500 s at a lag of "
                "100000.000000 ms, both by CLOCK_MONOTONIC");
}

TEST_F(WalkTakeTest, AnOutlierOnAFramesOwnTimeIsLeftOutAndSaid) {
  walk(test::linear_field, 20, Eigen::Quaterniond::Identity());
  const auto written = [&](const std::vector<int>& wrong) {
    std::ofstream file(poses());
    file << "time_ns,x,y,z\n";
    for (int i = 0; i < 20; ++i)
      file << kFirst_ns + i * kPeriod_ns << "," << 0.01 * i << ","
           << (std::find(wrong.begin(), wrong.end(), i) == wrong.end() ? 0 : 50) << ",0\n";
  };
  WalkOptions o = options();
  o.poses = poses();
  o.lag_s = 0;
  written({7});
  const auto take = opened(o);
  ASSERT_TRUE(take);
  EXPECT_EQ(take->counts().kept, 20u);
  EXPECT_LE((WalkTake::probes(take).positions[7] - Vec3d(0.07, 0, 0)).norm(), 1e-12);
  EXPECT_THAT(take->remarks(),
              ElementsAre(poses().string() +
                          ": 1 of 20 poses are outliers and are left out, the first: line 9 is 50 m and 0 "
                          "degrees from line 8, 0.02 s earlier: allowed up to 20 m/s and 720 degrees/s"));
  written({1, 3, 5, 7, 9, 11, 13, 15, 17, 19});
  const auto two_paths = WalkTake::open(o);
  ASSERT_FALSE(two_paths.ok());
  EXPECT_THAT(two_paths.error().message, HasSubstr("20 frames are among outliers or in jumps"));
  EXPECT_THAT(two_paths.error().message, HasSubstr("20 of 20 poses are outliers"));
}

TEST_F(WalkTakeTest, FramesThatTellNothingNewAreLeftOutAndTheFieldStays) {
  const Eigen::Quaterniond upright = Eigen::Quaterniond::Identity();
  walk(test::linear_field, 500, upright);
  WalkOptions o = options();
  o.redundant = {0.05, 0.1};
  const auto take = opened(o);
  ASSERT_TRUE(take);
  const WalkCounts& counts = take->counts();
  EXPECT_EQ(counts.redundant + counts.kept, 500u);
  EXPECT_GT(counts.redundant, 100u);
  const ProbeTake probes = WalkTake::probes(take);
  const double step_m =
      0.45 * 2 * kPi * std::sqrt(9 + 25 + 49) / 500;  // the most that the curve goes in a frame
  for (std::size_t i = 1; i < probes.positions.size(); ++i)
    EXPECT_LE((probes.positions[i] - probes.positions[i - 1]).norm(), std::max(0.1, step_m) + 1e-9);
  const auto built = build_field(probes, build_options(*take));
  ASSERT_TRUE(built.ok());
  EXPECT_LT(field_error(built->field, test::linear_field, upright), 0.01);
}

TEST_F(WalkTakeTest, SaturatedAndDamagedFramesAreCounted) {
  walk(test::linear_field, 150, Eigen::Quaterniond::Identity(), 3);
  const auto bright = opened(options());
  ASSERT_TRUE(bright);
  EXPECT_GT(bright->counts().clipped_frames, 0u);
  EXPECT_THAT(bright->remarks(), ElementsAre(HasSubstr("frames have saturated pixels, up to ")));
  // A byte of some frame in the middle.
  std::fstream file(take(), std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(std::filesystem::file_size(take()) / 2));
  file.put('\x5A').put('\xA5').put('\x5A');
  file.close();
  const auto damaged = opened(options());
  ASSERT_TRUE(damaged);
  EXPECT_EQ(damaged->counts().damaged, 1u);
  EXPECT_LT(damaged->counts().frames, 150u);
  EXPECT_THAT(damaged->remarks(), testing::Contains(HasSubstr("damaged in 1 places")));
  const ProbeTake probes = WalkTake::probes(damaged);
  for (std::size_t i = 0; i < probes.positions.size(); ++i) EXPECT_TRUE(probes.picture(i).ok());
}

TEST_F(WalkTakeTest, WhatIsMissingIsNamed) {
  walk(test::linear_field, 3, Eigen::Quaterniond::Identity());
  WalkOptions o = options();
  o.poses = folder_.path() / "none.csv";
  EXPECT_THAT(WalkTake::open(o).error().message, HasSubstr("none.csv"));
  o = options();
  o.calibration = folder_.path() / "none";
  EXPECT_THAT(WalkTake::open(o).error().message, HasSubstr("none"));
  o = options();
  o.take = folder_.path() / "none.mkv";
  EXPECT_THAT(WalkTake::open(o).error().message, HasSubstr("none.mkv"));
}

}  // namespace
}  // namespace lightwell
