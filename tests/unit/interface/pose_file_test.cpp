// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/pose_file.h"

#include <gtest/gtest.h>

#include <random>

#include "interface/atomic_file.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

PoseFile parsed(const std::string& text) {
  auto file = parse_poses(text, "poses.csv");
  EXPECT_TRUE(file.ok()) << (file.ok() ? "" : file.error().message);
  return file.ok() ? *file : PoseFile{};
}

void expect_refused(const std::string& text, const std::string& message) {
  const auto file = parse_poses(text, "poses.csv");
  ASSERT_FALSE(file.ok()) << text;
  EXPECT_EQ(file.error().kind, ErrorKind::bad_input);
  EXPECT_EQ(file.error().message, message);
}

TEST(PoseFile, PlacesAloneStandAsTheWorldDoes) {
  const PoseFile file =
      parsed("time_ns,x,y,z\n# walked twice\n9007199254740993,1,2,3\n9007199254740994,1.5,2,3\n");
  ASSERT_EQ(file.poses.size(), 2u);
  EXPECT_EQ(file.poses[0].time_ns, 9007199254740993) << "exact beyond a double's whole numbers";
  EXPECT_EQ(file.poses[1].pose.position_m, Vec3d(1.5, 2, 3));
  EXPECT_EQ(file.poses[1].pose.world_from_probe.w(), 1);
  EXPECT_EQ(file.lines, (std::vector<int>{3, 4}));
  EXPECT_FALSE(file.has_turns);
  EXPECT_FALSE(file.by_tracker_clock);
}

TEST(PoseFile, ATurnIsUnitAfterReading) {
  const PoseFile file = parsed("time_ns,qx,qy,qz,qw,x,y,z\n5,0,0.707,0,0.707,1,2,3\n");
  EXPECT_TRUE(file.has_turns);
  EXPECT_NEAR(file.poses[0].pose.world_from_probe.norm(), 1, 1e-15);
  EXPECT_LE((file.poses[0].pose.world_from_probe * Vec3d::UnitZ() - Vec3d::UnitX()).norm(), 1e-12);
}

TEST(PoseFile, WhatIsWrongIsNamedWithLineColumnAndRange) {
  expect_refused("time_ns,x,y\n1,2,3\n", "poses.csv: column z is missing; there are: time_ns, x, y");
  expect_refused("time_ns,x,y,z\n", "poses.csv: has no poses: allowed 1 line or more of time_ns,x,y,z");
  expect_refused("time_ns,x,y,z\n1,nan,0,0\n",
                 "poses.csv: line 2: x = nan: allowed -100000 to 100000 metres");
  expect_refused("time_ns,x,y,z\n1,0,0,0\n2,0,0,inf\n",
                 "poses.csv: line 3: z = inf: allowed -100000 to 100000 metres");
  expect_refused(
      "time_ns,x,y,z\n1.5,0,0,0\n",
      "poses.csv: line 2: time_ns = 1.5: allowed a whole number from 0 to 9200000000000000000 nanoseconds");
  expect_refused("time_ns,x,y,z\n7,0,0,0\n7,1,0,0\n",
                 "poses.csv: line 3: time_ns = 7: allowed above 7, that of the line before");
  expect_refused("time_ns,x,y,z\n7,0,0,0\n3,1,0,0\n",
                 "poses.csv: line 3: time_ns = 3: allowed above 7, that of the line before");
  expect_refused("time_ns,x,y,z,qw\n7,0,0,0,1\n",
                 "poses.csv: column qx is missing; there are: time_ns, x, y, z, qw");
  expect_refused("time_ns,x,y,z,qx,qy,qz,qw\n7,0,0,0,0,0,0,0\n",
                 "poses.csv: line 2: (qx, qy, qz, qw) has the length 0.000000: allowed 0.99 to 1.01");
  expect_refused("time_ns,x,y,z,qx,qy,qz,qw\n7,0,0,0,0,0,0,3\n",
                 "poses.csv: line 2: qw = 3: allowed -1 to 1");
  EXPECT_FALSE(read_poses("/nowhere/poses.csv").ok());
}

TEST(PoseFile, WhatIsWrittenIsReadAndAFileThatIsThereIsKept) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "take.poses.csv";
  {
    auto writer = PoseFileWriter::create(file, false);
    ASSERT_TRUE(writer.ok()) << writer.error().message;
    EXPECT_EQ(writer->hidden().parent_path(), folder.path());
    for (int i = 0; i < 3; ++i) {
      const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.3 * i, Vec3d(1, 2, 2) / 3));
      ASSERT_TRUE(writer->write({1'000'000'007LL * (i + 1), {{0.1 * i, -7.25, 3}, turn}}).ok());
      // As after a crash: every line is in the file already.
      EXPECT_EQ(read_poses(writer->hidden())->poses.size(), static_cast<std::size_t>(i) + 1);
    }
    EXPECT_FALSE(std::filesystem::exists(file));
    ASSERT_TRUE(writer->keep().ok());
  }
  const auto read = read_poses(file);
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read->poses[2].time_ns, 3'000'000'021);
  EXPECT_LE((read->poses[2].pose.position_m - Vec3d(0.2, -7.25, 3)).norm(), 1e-7);
  EXPECT_NEAR(Eigen::AngleAxisd(read->poses[2].pose.world_from_probe).angle(), 0.6, 1e-8);
  const auto again = PoseFileWriter::create(file, false);
  ASSERT_FALSE(again.ok());
  EXPECT_NE(again.error().message.find("not overwritten"), std::string::npos) << again.error().message;
}

TEST(PoseFile, WhatIsNotKeptLeavesNothingAndWhatCannotBeKeptIsNotLost) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "take.poses.csv";
  {
    auto writer = PoseFileWriter::create(file, false);
    ASSERT_TRUE(writer->write({1, {}}).ok());
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  std::filesystem::path hidden;
  {
    auto writer = PoseFileWriter::create(file, false);
    ASSERT_TRUE(writer->write({1, {}}).ok());
    hidden = writer->hidden();
    ASSERT_TRUE(write_file_atomically(file, "another's").ok());
    const Status kept = writer->keep();
    ASSERT_FALSE(kept.ok());
    EXPECT_NE(kept.error().message.find(hidden.string()), std::string::npos) << kept.error().message;
  }
  EXPECT_EQ(read_poses(hidden)->poses.size(), 1u);
  EXPECT_EQ(*read_text_file(file), "another's");
}

TEST(PoseFile, TheTrackersOwnClockTakesTheNetworksDelaysOut) {
  // Sampled each 10 ms, on its way for 2 ms and up to 20 ms more; at the tracker it is 1 s past no epoch of ours.
  std::mt19937 random(1);
  std::uniform_int_distribution<std::int64_t> more(0, 8'000'000);
  std::string text = "time_ns,x,y,z,sample_ns\n", without = "time_ns,x,y,z,sample_ns\n";
  constexpr std::int64_t kStart = 50'000'000'000, kDelay = 2'000'000;
  constexpr int kPoses = 1000;
  for (int i = 0; i < kPoses; ++i) {
    const std::int64_t sampled = 1'000'000'000 + 10'000'000LL * i;
    const std::int64_t arrived = kStart + 10'000'000LL * i + kDelay + more(random);
    text += std::to_string(arrived) + ",0,0,0," + std::to_string(sampled) + "\n";
    without += std::to_string(arrived) + ",0,0,0," + (i == 500 ? "" : std::to_string(sampled)) + "\n";
  }
  const PoseFile file = parsed(text);
  EXPECT_TRUE(file.by_tracker_clock);
  for (int i = 0; i < kPoses; ++i) {
    const std::int64_t late = file.poses[static_cast<std::size_t>(i)].time_ns - (kStart + 10'000'000LL * i);
    EXPECT_GE(late, kDelay);
    // The least of 500 delays or more, spread evenly over 8 ms, is below 0.2 ms but for one in e^12.
    EXPECT_LE(late, kDelay + 200'000);
  }
  EXPECT_FALSE(parsed(without).by_tracker_clock) << "a pose without a stamp";
}

TEST(PoseFile, ALastLineThatWasCutOffIsLeftOutAndSaid) {
  const std::string whole = "time_ns,x,y,z\n100,1,2,3\n200,1.5,2,3\n300,1.25,2,3.125\n";
  const auto third = whole.find("300");
  for (std::size_t size = third + 1; size < whole.size();
       ++size) {  // numbers that are cut may read as others
    const PoseFile file = parsed(whole.substr(0, size));
    ASSERT_EQ(file.poses.size(), 2u) << size;
    ASSERT_EQ(file.remarks.size(), 1u);
    EXPECT_EQ(file.remarks[0], "line 4, the last, has no line end: it was cut off and is left out");
  }
  EXPECT_TRUE(parsed(whole).remarks.empty());
  EXPECT_TRUE(parsed(whole.substr(0, third) + "  ").remarks.empty());
  EXPECT_EQ(parsed("time_ns,x,y,z\n100,1,2,3").poses.size(), 1u) << "the only pose of a file made by hand";
  expect_refused("time_ns,x,y,z\n100,1,2", "poses.csv: line 2: 3 fields: allowed 4, as in the header");
}

TEST(PoseFile, ATrackersClockThatIsSetBeginsAnewAndIsSaid) {
  constexpr std::int64_t kMs = 1'000'000, kHour = 3'600'000 * kMs, kStart = 2 * kHour;
  std::string text = "time_ns,x,y,z,sample_ns\n";
  for (int i = 0; i < 600; ++i) {
    const std::int64_t ours = kStart + 10 * kMs * i;
    const std::int64_t theirs = kStart + 10 * kMs * i - (i < 200 ? 0 : i < 400 ? kHour : 500 * kMs);
    text += std::to_string(ours + (2 + i * 7 % 5) * kMs) + ",0,0,0," + std::to_string(theirs) + "\n";
  }
  const PoseFile file = parsed(text);
  ASSERT_EQ(file.poses.size(), 600u);
  EXPECT_TRUE(file.by_tracker_clock);
  ASSERT_EQ(file.remarks.size(), 2u);
  EXPECT_EQ(file.remarks[0], "line 202: the tracker's clock (sample_ns) was set back by 3600.000 s");
  EXPECT_EQ(file.remarks[1], "line 402: the tracker's clock (sample_ns) was set forward by 3599.500 s");
  for (int i = 0; i < 600; ++i)
    EXPECT_EQ(file.poses[static_cast<std::size_t>(i)].time_ns, kStart + 10 * kMs * i + 2 * kMs) << i;
}

TEST(PoseFile, AClockThatIsSetAgainAndAgainIsNotUsed) {
  std::string text = "time_ns,x,y,z,sample_ns\n";
  for (int i = 0; i < 100; ++i) text += std::to_string(1000 + i) + ",0,0,0," + std::to_string(500 - i) + "\n";
  const PoseFile file = parsed(text);
  EXPECT_FALSE(file.by_tracker_clock);
  EXPECT_EQ(file.poses[99].time_ns, 1099);
  ASSERT_EQ(file.remarks.size(), 1u);
  EXPECT_EQ(
      file.remarks[0],
      "the tracker's clock (sample_ns) was set 99 times, the first in line 3: it is not used, poses have "
      "their times of arrival");
  expect_refused("time_ns,x,y,z,sample_ns\n1,0,0,0,5\n2,0,0,0,5\n",
                 "poses.csv: line 3: sample_ns = 5: allowed another than that of the line before");
}

}  // namespace
}  // namespace lightwell
