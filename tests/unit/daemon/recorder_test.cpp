// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/record/recorder.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <thread>

#include "daemon/record/frame_ring.h"
#include "tests/support/eventually.h"
#include "tests/support/takes.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

using test::eventually;
using test::TakeFrame;
using test::TemporaryFolder;

constexpr FrameFormat kFormat{40, 30, PixelFormat::mono12};

FrameInfo info_of(const TakeFrame& frame, const FrameFormat& format = kFormat) {
  return {.format = format,
          .sequence = frame.info.sequence,
          .capture_mono_ns = frame.info.capture_mono_ns,
          .received_mono_ns = frame.info.received_mono_ns,
          .capture_utc_ns = frame.info.capture_utc_ns,
          .exposure_us = frame.info.exposure_us,
          .gain_db = frame.info.gain_db,
          .temperature_c = frame.info.temperature_c,
          .complete = true};
}

RecordingHeader header() {
  return test::take_header(kFormat, RecordingCodec::raw);
}

test::ReadTake read_take(const std::filesystem::path& file) {
  auto reader = RecordingReader::open(file);
  EXPECT_TRUE(reader) << reader.error().message;
  return reader ? test::read_all(**reader) : test::ReadTake();
}

TEST(Recorder, WritesWhatItIsOfferedBitForBit) {
  const TemporaryFolder folder;
  Recorder recorder(folder.path());
  const auto frames = test::take_frames(kFormat, 50);
  recorder.offer(info_of(frames[0]), frames[0].codes);  // before the start: not recorded
  ASSERT_TRUE(recorder.start("take.mkv", header()));
  EXPECT_TRUE(recorder.stats().active);
  for (const TakeFrame& frame : frames) recorder.offer(info_of(frame), frame.codes);
  ASSERT_TRUE(recorder.stop());
  recorder.offer(info_of(frames[0]), frames[0].codes);  // after the end: not recorded

  const Recorder::Stats stats = recorder.stats();
  EXPECT_FALSE(stats.active);
  EXPECT_EQ(stats.file, "take.mkv");
  EXPECT_EQ(stats.frames, 50u);
  EXPECT_EQ(stats.dropped, 0u);
  EXPECT_EQ(stats.error, "");
  EXPECT_EQ(stats.bytes, std::filesystem::file_size(folder.path() / "take.mkv"));
  const auto take = read_take(folder.path() / "take.mkv");
  EXPECT_TRUE(take.complaints.empty());
  ASSERT_EQ(take.frames.size(), frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) EXPECT_TRUE(same(take.frames[i], frames[i]));
}

TEST(Recorder, LeavesIncompleteFramesOut) {
  const TemporaryFolder folder;
  Recorder recorder(folder.path());
  ASSERT_TRUE(recorder.start("take.mkv", header()));
  const auto frames = test::take_frames(kFormat, 2);
  FrameInfo incomplete = info_of(frames[0]);
  incomplete.complete = false;
  recorder.offer(incomplete, frames[0].codes);
  recorder.offer(info_of(frames[1]), frames[1].codes);
  ASSERT_TRUE(recorder.stop());
  EXPECT_EQ(read_take(folder.path() / "take.mkv").frames.size(), 1u);
}

TEST(Recorder, OneTakeAfterAnother) {
  const TemporaryFolder folder;
  Recorder recorder(folder.path());
  const auto frames = test::take_frames(kFormat, 3);
  for (const char* file : {"a.mkv", "b.mkv"}) {
    ASSERT_TRUE(recorder.start(file, header()));
    EXPECT_EQ(recorder.start("c.mkv", header()).error().kind, ErrorKind::failed);  // one at a time
    for (const TakeFrame& frame : frames) recorder.offer(info_of(frame), frame.codes);
    ASSERT_TRUE(recorder.stop());
    EXPECT_EQ(recorder.stop().error().kind, ErrorKind::failed);
  }
  EXPECT_EQ(read_take(folder.path() / "a.mkv").frames.size(), 3u);
  EXPECT_EQ(read_take(folder.path() / "b.mkv").frames.size(), 3u);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "c.mkv"));
}

TEST(Recorder, TheDestructorClosesTheTake) {
  const TemporaryFolder folder;
  const TakeFrame frame = test::take_frame(kFormat, 0);
  {
    Recorder recorder(folder.path());
    ASSERT_TRUE(recorder.start("take.mkv", header()));
    recorder.offer(info_of(frame), frame.codes);
  }
  auto reader = RecordingReader::open(folder.path() / "take.mkv");
  ASSERT_TRUE(reader);
  EXPECT_TRUE((*reader)->complete());
}

TEST(Recorder, OnlyPlainNewNamesInsideItsDirectory) {
  const TemporaryFolder folder;
  Recorder recorder(folder.path());
  for (const std::string& file :
       {std::string(), std::string(".mkv"), std::string("take"), std::string("take.avi"),
        std::string("/etc/take.mkv"), std::string("../take.mkv"), std::string("a/b.mkv"),
        std::string(".hidden.mkv"), std::string("a\nb.mkv"), std::string("a\0b.mkv", 7),
        std::string("-a.mkv"), std::string("\xc3\xa9.mkv"), std::string("a;b.mkv"),
        std::string(125, 'x') + ".mkv", std::string(" .mkv"), std::string("   .mkv")}) {
    const Status status = recorder.start(file, header());
    ASSERT_FALSE(status) << file;
    EXPECT_EQ(status.error().kind, ErrorKind::usage) << file;
    EXPECT_EQ(status.error().message.find('\n'), std::string::npos);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  test::write_bytes(folder.path() / "there.mkv", "precious");
  EXPECT_EQ(recorder.start("there.mkv", header()).error().kind, ErrorKind::failed);
  EXPECT_EQ(test::file_bytes(folder.path() / "there.mkv"), "precious");
  Recorder homeless("/nonexistent");
  EXPECT_EQ(homeless.start("take.mkv", header()).error().kind, ErrorKind::failed);
  EXPECT_FALSE(homeless.stats().active);
}

TEST(Recorder, AnotherFormatEndsTheTakeCleanly) {
  const TemporaryFolder folder;
  Recorder recorder(folder.path());
  ASSERT_TRUE(recorder.start("take.mkv", header()));
  const TakeFrame frame = test::take_frame(kFormat, 0);
  recorder.offer(info_of(frame), frame.codes);
  const FrameFormat larger{80, 60, PixelFormat::mono8};
  const TakeFrame other = test::take_frame(larger, 1);
  recorder.offer(info_of(other, larger), other.codes);
  ASSERT_TRUE(eventually([&] { return !recorder.stats().active; }));
  EXPECT_NE(recorder.stats().error.find("40x30 Mono12"), std::string::npos) << recorder.stats().error;
  recorder.offer(info_of(frame), frame.codes);  // the old size again: the take is over
  EXPECT_FALSE(recorder.stop());
  EXPECT_EQ(read_take(folder.path() / "take.mkv").frames.size(), 1u);
  EXPECT_TRUE(recorder.start("next.mkv", header()));
}

// The frame path outruns the writer on purpose: what does not fit is counted, what fits is whole and in
// order.
TEST(Recorder, FramesThatDoNotFitAreCountedAndNothingElseIsLost) {
  const TemporaryFolder folder;
  const FrameFormat format{640, 480, PixelFormat::mono12};
  Recorder recorder(folder.path(), 1);  // the smallest ring
  ASSERT_TRUE(recorder.start("take.mkv", test::take_header(format, RecordingCodec::ffv1)));
  TakeFrame frame = test::take_frame(format, 0);
  std::uint64_t offered = 0;
  ASSERT_TRUE(eventually([&] {
    for (int i = 0; i < 50; ++i, ++offered, ++frame.info.sequence)
      recorder.offer(info_of(frame, format), frame.codes);
    return recorder.stats().dropped > 0;
  }));
  ASSERT_TRUE(recorder.stop());
  const Recorder::Stats stats = recorder.stats();
  EXPECT_EQ(stats.frames + stats.dropped, offered);
  EXPECT_EQ(stats.error, "");
  const auto take = read_take(folder.path() / "take.mkv");
  EXPECT_TRUE(take.complaints.empty());
  EXPECT_EQ(take.frames.size(), stats.frames);
  for (std::size_t i = 1; i < take.frames.size(); ++i)
    EXPECT_GT(take.frames[i].info.sequence, take.frames[i - 1].info.sequence);
}

// Start, stop and stats from their own threads while frames are offered: for the thread sanitizer, and no
// frame of a take may be lost to somebody who only asks for numbers.
TEST(Recorder, StartStopAndStatsFromAnyThreadWhileFramesArrive) {
  const TemporaryFolder folder;
  Recorder recorder(folder.path());
  std::atomic<bool> done{false};
  std::thread frame_path([&] {
    TakeFrame frame = test::take_frame(kFormat, 0);
    for (; !done; ++frame.info.sequence) {
      recorder.offer(info_of(frame), frame.codes);
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  });
  std::thread monitor([&] {
    while (!done) static_cast<void>(recorder.stats());
  });
  for (int i = 0; i < 5; ++i) {
    const std::string file = std::to_string(i) + ".mkv";
    ASSERT_TRUE(recorder.start(file, header()));
    ASSERT_TRUE(eventually([&] { return recorder.stats().frames >= 20; }));
    ASSERT_TRUE(recorder.stop());
    const auto take = read_take(folder.path() / file);
    EXPECT_TRUE(take.complaints.empty());
    ASSERT_GE(take.frames.size(), 20u);
    const std::uint64_t span = take.frames.back().info.sequence - take.frames.front().info.sequence + 1;
    EXPECT_LE(span, take.frames.size() + recorder.stats().dropped);
  }
  done = true;
  frame_path.join();
  monitor.join();
}

// A limit on the size of files stands in for a full disk; in a process of its own, since it holds for all its
// files.
TEST(Recorder, FullDiskEndsTheTakeReadableAndKeepsTheReason) {
  const TemporaryFolder folder;
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{200'000, 200'000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    Recorder recorder(folder.path());
    if (!recorder.start("take.mkv", header())) ::_exit(1);
    TakeFrame frame = test::take_frame(kFormat, 0);
    // Frames pause: what came so far reaches the disk by itself.
    for (int i = 0; i < 20; ++i, ++frame.info.sequence) recorder.offer(info_of(frame), frame.codes);
    const bool flushed = eventually(
        [&] { return std::filesystem::file_size(folder.path() / "take.mkv") > 20 * kFormat.bytes(); });
    if (!flushed) ::_exit(6);
    const bool stopped = eventually([&] {
      for (int i = 0; i < 5; ++i, ++frame.info.sequence) recorder.offer(info_of(frame), frame.codes);
      return !recorder.stats().active;
    });
    const Recorder::Stats stats = recorder.stats();
    if (!stopped) ::_exit(2);
    if (stats.error.find("take.mkv") == std::string::npos) ::_exit(3);
    if (stats.bytes > 200'000) ::_exit(4);
    ::_exit(recorder.stop() ? 5 : 0);  // the reason is told again
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0) << "see the exit codes above";
  const auto reader = RecordingReader::open(folder.path() / "take.mkv");
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_GE(test::read_all(**reader).frames.size(), 20u);
}

TEST(Recorder, ATakeWithoutFramesIsRemovedAndSaidSo) {
  const TemporaryFolder folder;
  Recorder recorder(folder.path());
  ASSERT_TRUE(recorder.start("take.mkv", header()));
  const Status stopped = recorder.stop();
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::failed);
  EXPECT_NE(stopped.error().message.find("no frame came, the file is removed"), std::string::npos);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  EXPECT_EQ(recorder.stats().bytes, 0u);
  EXPECT_TRUE(recorder.start("take.mkv", header()));  // the name is free again
}

TEST(Recorder, ATakeWithoutFramesRemovesNoFileThatGotItsNameMeanwhile) {
  const TemporaryFolder folder;
  Recorder recorder(folder.path());
  ASSERT_TRUE(recorder.start("take.mkv", header()));
  std::filesystem::rename(folder.path() / "take.mkv", folder.path() / "moved.mkv");
  test::write_bytes(folder.path() / "take.mkv", "precious");
  EXPECT_FALSE(recorder.stop());
  EXPECT_EQ(test::file_bytes(folder.path() / "take.mkv"), "precious");
}

TEST(Recorder, AFullDiskBeforeTheFirstWholeFrameLeavesNoFileAndClaimsNone) {
  const TemporaryFolder folder;
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{100, 100};  // less than a take's header
    ::setrlimit(RLIMIT_FSIZE, &limit);
    Recorder recorder(folder.path());
    if (recorder.start("take.mkv", header())) {  // what is buffered reaches the disk with the first cluster
      const TakeFrame frame = test::take_frame(kFormat, 0);
      recorder.offer(info_of(frame), frame.codes);
      const Status stopped = recorder.stop();
      if (stopped) ::_exit(1);
      if (stopped.error().message.find("kept") != std::string::npos) ::_exit(2);
      if (stopped.error().message.find("removed") == std::string::npos) ::_exit(3);
    }
    ::_exit(std::filesystem::is_empty(folder.path()) ? 0 : 4);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0) << "see the exit codes above";
}

TEST(FrameRing, IsFullWithItsCapacityAndEmptyAgainInOrder) {
  FrameRing ring(3, 2);
  const std::array<std::byte, 3> codes{std::byte{1}, std::byte{2}, std::byte{3}};
  RecordedFrame frame;
  for (std::uint64_t round = 0; round < 5; ++round) {
    frame.sequence = 2 * round;
    EXPECT_TRUE(ring.push(frame, codes));
    frame.sequence = 2 * round + 1;
    EXPECT_TRUE(ring.push(frame, codes));
    EXPECT_FALSE(ring.push(frame, codes));
    for (std::uint64_t i = 0; i < 2; ++i) {
      ASSERT_FALSE(ring.empty());
      EXPECT_EQ(ring.front().frame.sequence, 2 * round + i);
      EXPECT_TRUE(std::equal(codes.begin(), codes.end(), ring.front().codes.begin()));
      ring.pop();
    }
    EXPECT_TRUE(ring.empty());
  }
  EXPECT_FALSE(ring.push(frame, std::span(codes).first(2)));
}

}  // namespace
}  // namespace lightwell
