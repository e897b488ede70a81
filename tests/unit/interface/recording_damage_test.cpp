// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Takes that were cut, damaged or ran out of disk.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <random>

#include "interface/recording.h"
#include "tests/support/takes.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

using test::read_all;
using test::TakeFrame;
using test::TemporaryFolder;

constexpr FrameFormat kSmall{24, 10, PixelFormat::mono12};
constexpr std::uint32_t kFrames = 30;
constexpr std::size_t kCluster = 5;  // frames

class DamagedRecording : public testing::TestWithParam<RecordingCodec> {
 protected:
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(
        test::write_take(whole_, test::take_header(kSmall, GetParam()), frames_, kCluster));
    bytes_ = test::file_bytes(whole_);
  }

  // Whatever was delivered is one of the frames, bit for bit, and in order.
  void expect_only_true_frames(const std::vector<TakeFrame>& got) const {
    std::uint64_t last = 0;
    for (const TakeFrame& frame : got) {
      ASSERT_GE(frame.info.sequence, 1000u);
      ASSERT_LT(frame.info.sequence, 1000u + kFrames);
      EXPECT_TRUE(same(frame, frames_[frame.info.sequence - 1000]));
      EXPECT_GT(frame.info.sequence, last);
      last = frame.info.sequence;
    }
  }

  // Where frame i's codes end in the file. Noise does not repeat; raw frames stand in the file as they are.
  [[nodiscard]] std::size_t end_of_codes(std::size_t i) const {
    const auto& codes = frames_[i].codes;
    const std::string text(reinterpret_cast<const char*>(codes.data()), codes.size());
    const std::size_t at = bytes_.find(text);
    return at == std::string::npos ? at : at + text.size();
  }

  TemporaryFolder folder_;
  std::filesystem::path whole_ = folder_.path() / "whole.mkv";
  std::filesystem::path broken_ = folder_.path() / "broken.mkv";
  std::vector<TakeFrame> frames_ = test::take_frames(kSmall, kFrames);
  std::string bytes_;
};

// Where the codes can be found in the file, to cut and damage it there.
class DamagedRawRecording : public DamagedRecording {};

TEST_P(DamagedRecording, CutAnywhereDeliversWholeFramesAndThenSaysWhatIsWrong) {
  std::size_t delivered_before = 0;
  constexpr std::size_t kPositions = 150;
  for (std::size_t i = 0; i < kPositions; ++i) {
    const std::size_t cut = bytes_.size() * i / kPositions;
    SCOPED_TRACE("cut at " + std::to_string(cut) + " of " + std::to_string(bytes_.size()));
    test::write_bytes(broken_, bytes_.substr(0, cut));
    const auto reader = RecordingReader::open(broken_);
    if (!reader) {
      EXPECT_EQ(reader.error().kind, ErrorKind::bad_input);
      EXPECT_NE(reader.error().message.find(broken_.string()), std::string::npos);
      EXPECT_EQ(delivered_before, 0u);  // a longer piece never gives fewer frames
      continue;
    }
    EXPECT_FALSE((*reader)->complete());
    const auto take = read_all(**reader);
    expect_only_true_frames(take.frames);
    ASSERT_FALSE(take.complaints.empty());
    EXPECT_EQ(take.complaints.back().kind, ErrorKind::bad_input);
    EXPECT_NE(take.complaints.back().message.find(broken_.string()), std::string::npos);
    EXPECT_GE(take.frames.size(), delivered_before);
    delivered_before = take.frames.size();
    EXPECT_EQ((*reader)->frame_count().value(), take.frames.size());
  }
  EXPECT_EQ(delivered_before, kFrames);  // the last cuts fall into the index behind all frames
}

TEST_P(DamagedRecording, ACutBeforeTheFirstClusterIsCalledACutHeader) {
  const std::size_t cluster = bytes_.find("\x1F\x43\xB6\x75");  // Matroska's Cluster, RFC 9559
  ASSERT_NE(cluster, std::string::npos);
  constexpr std::size_t kSegmentStarts = 64;  // before it the file is not known as Matroska
  for (std::size_t cut = kSegmentStarts; cut < cluster; cut += 13) {
    SCOPED_TRACE("cut at " + std::to_string(cut) + " of " + std::to_string(cluster));
    test::write_bytes(broken_, bytes_.substr(0, cut));
    const auto reader = RecordingReader::open(broken_);
    ASSERT_FALSE(reader);
    EXPECT_EQ(reader.error().kind, ErrorKind::bad_input);
    EXPECT_NE(reader.error().message.find("cut within its header"), std::string::npos)
        << reader.error().message;
  }
}

TEST_P(DamagedRawRecording, EveryFrameBeforeACutIsDelivered) {
  for (std::size_t i = 0; i < kFrames; ++i) {
    const std::size_t end = end_of_codes(i);
    ASSERT_NE(end, std::string::npos);
    constexpr std::size_t kRecordAndWrapping =
        100;  // the frame's record follows its codes: 76 bytes and three headers
    test::write_bytes(broken_, bytes_.substr(0, end + kRecordAndWrapping));
    const auto reader = RecordingReader::open(broken_);
    ASSERT_TRUE(reader) << reader.error().message;
    EXPECT_GE(read_all(**reader).frames.size(), i + 1);
  }
}

TEST_P(DamagedRecording, FlippedBytesNeverYieldAFalseFrame) {
  std::mt19937 random(7);
  for (int round = 0; round < 300; ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    std::string damaged = bytes_;
    const int flips = 1 + round % 4;
    for (int k = 0; k < flips; ++k)
      damaged[random() % damaged.size()] ^= static_cast<char>(1 << random() % 8);
    test::write_bytes(broken_, damaged);
    const auto reader = RecordingReader::open(broken_);
    if (!reader) {
      EXPECT_EQ(reader.error().kind, ErrorKind::bad_input);
      continue;
    }
    const auto take = read_all(**reader);
    expect_only_true_frames(take.frames);
    if (take.frames.size() < kFrames) {
      EXPECT_FALSE(take.complaints.empty());
    }
    EXPECT_EQ((*reader)->header().calibration_json, test::take_header(kSmall, GetParam()).calibration_json);
  }
}

TEST_P(DamagedRecording, GarbageOfEveryLengthIsBadInput) {
  std::mt19937 random(11);
  for (std::size_t length = 0; length < 4096; length = length * 2 + 1) {
    std::string garbage = bytes_.substr(0, std::min<std::size_t>(length / 2, 60));  // starts like a take
    while (garbage.size() < length) garbage.push_back(static_cast<char>(random() & 0xff));
    test::write_bytes(broken_, garbage);
    const auto reader = RecordingReader::open(broken_);
    ASSERT_FALSE(reader);
    EXPECT_EQ(reader.error().kind, ErrorKind::bad_input);
  }
}

TEST_P(DamagedRawRecording, OneDamagedFrameCostsThatFrameAlone) {
  std::string damaged = bytes_;
  damaged[end_of_codes(12) - 7] ^= 0x10;
  test::write_bytes(broken_, damaged);
  const auto reader = RecordingReader::open(broken_);
  ASSERT_TRUE(reader);
  const auto take = read_all(**reader);
  EXPECT_EQ(take.before_damage, 12u);
  EXPECT_EQ(take.frames.size(), kFrames - 1u);
  ASSERT_EQ(take.complaints.size(), 1u);
  EXPECT_NE(take.complaints[0].message.find("frame 12"), std::string::npos) << take.complaints[0].message;
}

// What a process that is killed leaves: the writer never closes.
TEST_P(DamagedRecording, AKilledWriterLeavesItsWrittenClustersReadable) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    auto writer = RecordingWriter::create(broken_, test::take_header(kSmall, GetParam()));
    bool good = writer.ok();
    for (std::size_t i = 0; good && i < 20; ++i) {
      good = (*writer)->write(frames_[i].info, frames_[i].codes).ok();
      if (i == 14) good = good && (*writer)->flush().ok();
    }
    if (good) ::raise(SIGKILL);
    ::_exit(1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  const auto reader = RecordingReader::open(broken_);
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_FALSE((*reader)->complete());
  const auto take = read_all(**reader);
  expect_only_true_frames(take.frames);
  EXPECT_GE(take.frames.size(), 15u);
}

TEST_P(DamagedRecording, RepairRecoversEveryWholeFrameAndLeavesTheInputAlone) {
  const auto mended = folder_.path() / "mended.mkv";
  test::write_bytes(broken_, bytes_.substr(0, bytes_.size() * 2 / 3));
  const std::string before = test::file_bytes(broken_);
  const auto broken_reader = RecordingReader::open(broken_);
  ASSERT_TRUE(broken_reader);
  const auto expected = read_all(**broken_reader).frames;
  ASSERT_GT(expected.size(), 10u);

  const auto report = repair_recording(broken_, mended);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->recovered, expected.size());
  EXPECT_EQ(test::file_bytes(broken_), before);

  const auto reader = RecordingReader::open(mended);
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_TRUE((*reader)->complete());
  EXPECT_EQ((*reader)->frame_count().value(), expected.size());
  EXPECT_EQ((*reader)->header().calibration_json, test::take_header(kSmall, GetParam()).calibration_json);
  const auto take = read_all(**reader);
  EXPECT_TRUE(take.complaints.empty());
  ASSERT_EQ(take.frames.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_TRUE(same(take.frames[i], expected[i]));
  expect_only_true_frames(take.frames);
}

TEST_P(DamagedRawRecording, RepairGoesOnBehindDamage) {
  std::string damaged = bytes_;
  for (std::size_t k = end_of_codes(7) - 50; k < end_of_codes(8); ++k)
    damaged[k] = 0;  // from one frame into the next
  test::write_bytes(broken_, damaged);
  const auto report = repair_recording(broken_, folder_.path() / "mended.mkv");
  ASSERT_TRUE(report) << report.error().message;
  // Frames 7 and 8 are gone; the demuxer may need the next cluster (frame 10) to find its way.
  EXPECT_GE(report->recovered, kFrames - 3u);
  EXPECT_EQ(report->recovered + report->damaged, kFrames);
}

TEST_P(DamagedRecording, RepairSavesFramesWhoseCalibrationIsDamaged) {
  std::string damaged = bytes_;
  const std::size_t at = damaged.find(R"({"schema": "test"})");
  ASSERT_NE(at, std::string::npos);
  damaged[at + 13] = 'T';
  test::write_bytes(broken_, damaged);
  const auto reader = RecordingReader::open(broken_);
  ASSERT_FALSE(reader);
  EXPECT_NE(reader.error().message.find("calibration"), std::string::npos) << reader.error().message;
  const auto report = repair_recording(broken_, folder_.path() / "mended.mkv");
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->recovered, kFrames);
  EXPECT_TRUE(report->calibration_lost);
}

TEST_P(DamagedRecording, RepairOfNothingLeavesNothing) {
  const auto mended = folder_.path() / "mended.mkv";
  test::write_bytes(broken_, bytes_.substr(0, 100));
  EXPECT_EQ(repair_recording(broken_, mended).error().kind, ErrorKind::bad_input);
  EXPECT_EQ(repair_recording(folder_.path() / "absent.mkv", mended).error().kind, ErrorKind::bad_input);
  EXPECT_EQ(repair_recording(whole_, "/nonexistent/mended.mkv").error().kind, ErrorKind::failed);
  EXPECT_EQ(repair_recording(whole_, whole_).error().kind, ErrorKind::failed);
  EXPECT_EQ(test::file_bytes(whole_), bytes_);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 2);  // whole and broken
}

// A limit on the size of files stands in for a full disk, without needing one. In a process of its own: the
// limit holds for all of the process's files.
TEST_P(DamagedRecording, FullDiskEndsWithAReadableTakeAndAnError) {
  const FrameFormat format{64, 48, PixelFormat::mono16};
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{100'000, 100'000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    auto writer = RecordingWriter::create(broken_, test::take_header(format, GetParam()));
    if (!writer) ::_exit(10);
    Status status;
    std::uint32_t i = 0;
    for (; i < 100 && status; ++i) {
      const TakeFrame frame = test::take_frame(format, i);
      status = (*writer)->write(frame.info, frame.codes);
      if (status && i % 3 == 2) status = (*writer)->flush();
    }
    if (status) ::_exit(11);
    if (status.error().kind != ErrorKind::failed) ::_exit(12);
    if (status.error().message.find(broken_.string()) == std::string::npos) ::_exit(13);
    const TakeFrame more = test::take_frame(format, i);
    if ((*writer)->write(more.info, more.codes).ok()) ::_exit(14);  // and stays failed
    if ((*writer)->close().ok()) ::_exit(15);
    ::_exit(static_cast<int>((*writer)->frames()) + 100);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  const int code = WEXITSTATUS(status);
  ASSERT_GT(code, 100) << "the writer of the full disk, see the exit codes above";
  const auto reader = RecordingReader::open(broken_);
  ASSERT_TRUE(reader) << reader.error().message;
  const auto take = read_all(**reader);
  EXPECT_EQ(take.frames.size(), static_cast<std::size_t>(code - 100));
  for (std::size_t i = 0; i < take.frames.size(); ++i)
    EXPECT_TRUE(same(take.frames[i], test::take_frame(format, static_cast<std::uint32_t>(i))));
}

std::string codec_name(const testing::TestParamInfo<RecordingCodec>& info) {
  return std::string(name(info.param));
}
INSTANTIATE_TEST_SUITE_P(Both, DamagedRecording, testing::Values(RecordingCodec::raw, RecordingCodec::ffv1),
                         codec_name);
INSTANTIATE_TEST_SUITE_P(One, DamagedRawRecording, testing::Values(RecordingCodec::raw), codec_name);

}  // namespace
}  // namespace lightwell
