// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/recording_source.h"

#include <gtest/gtest.h>

#include <limits>

#include "daemon/capture/recorded_times.h"
#include "daemon/clock.h"
#include "tests/support/eventually.h"
#include "tests/support/takes.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

using namespace std::chrono_literals;
using test::TakeFrame;

constexpr FrameFormat kFormat{20, 12, PixelFormat::mono12p};
constexpr auto kPatience = 20s;  // ends a test that would hang; never reached on a machine that works

class RecordingSourceTest : public testing::Test {
 protected:
  void make_take(std::uint32_t count, double rate_hz = 60) {
    frames_ = test::take_frames(kFormat, count);
    auto header = test::take_header(kFormat, RecordingCodec::raw);
    header.rate_hz = rate_hz;
    ASSERT_NO_FATAL_FAILURE(test::write_take(file_, header, frames_));
  }
  std::unique_ptr<CaptureSource> start(double speed, bool loop = false, int buffers = 4) {
    CaptureOptions options;
    options.speed = speed;
    options.loop = loop;
    options.buffers = buffers;
    auto source = make_recording_source(file_, options);
    EXPECT_TRUE(source) << source.error().message;
    if (!source) return nullptr;
    EXPECT_TRUE((*source)->start());
    return std::move(*source);
  }
  static bool ended(const CaptureSource& source) { return source.state() == SourceState::ended; }
  // The next frame, however long the machine takes; empty only when the take is over.
  static FrameLease next(CaptureSource& source) {
    const auto until = std::chrono::steady_clock::now() + kPatience;
    while (std::chrono::steady_clock::now() < until) {
      if (FrameLease lease = source.wait(20ms)) return lease;
      if (ended(source)) break;
    }
    return {};
  }
  static RecordedFrame info_of(const FrameLease& lease) {
    const FrameInfo& info = lease.info();
    return {info.sequence,    info.capture_mono_ns, info.received_mono_ns, info.capture_utc_ns,
            info.exposure_us, info.gain_db,         info.temperature_c};
  }
  static bool same_codes(const FrameLease& lease, const TakeFrame& frame) {
    return std::equal(lease.bytes().begin(), lease.bytes().end(), frame.codes.begin(), frame.codes.end());
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "take.mkv";
  std::vector<TakeFrame> frames_;
};

TEST_F(RecordingSourceTest, LosslessGivesEveryFrameInOrderBitForBit) {
  ASSERT_NO_FATAL_FAILURE(make_take(200));
  const auto source = start(0);
  ASSERT_TRUE(source);
  for (const TakeFrame& expected : frames_) {
    const FrameLease lease = next(*source);
    ASSERT_TRUE(lease);
    EXPECT_EQ(lease.info().format, kFormat);
    EXPECT_TRUE(lease.info().complete);
    EXPECT_TRUE(test::same_bits(info_of(lease), expected.info));
    EXPECT_TRUE(same_codes(lease, expected));
  }
  EXPECT_FALSE(next(*source));
  EXPECT_EQ(source->state(), SourceState::ended);
  EXPECT_EQ(source->counters().received, 200u);
  EXPECT_EQ(source->counters().skipped, 0u);
  EXPECT_EQ(source->counters().lost, 0u);
}

TEST_F(RecordingSourceTest, LosslessWaitsForASlowReader) {
  ASSERT_NO_FATAL_FAILURE(make_take(30));
  const auto source = start(0, false, 3);
  ASSERT_TRUE(source);
  std::vector<FrameLease> held;
  while (held.size() < 3) {
    held.push_back(next(*source));
    ASSERT_TRUE(held.back());
  }
  EXPECT_FALSE(source->wait(30ms));  // every buffer is held
  EXPECT_NE(source->state(), SourceState::ended);
  for (std::size_t i = 0; i < held.size(); ++i) EXPECT_TRUE(same_codes(held[i], frames_[i]));
  held.clear();
  std::size_t count = 3;
  while (next(*source)) ++count;
  EXPECT_EQ(count, frames_.size());
}

TEST_F(RecordingSourceTest, PacedGivesTheFreshestAndCountsTheRest) {
  ASSERT_NO_FATAL_FAILURE(make_take(100));
  const auto source = start(1000);
  ASSERT_TRUE(source);
  // Nobody takes frames: of those that are due only the freshest is kept, and the pool of four holds the
  // last.
  ASSERT_TRUE(test::eventually([&] { return source->counters().received >= 96; }));
  std::uint64_t taken = 0;
  std::uint64_t last = 0;
  while (const FrameLease lease = next(*source)) {
    ++taken;
    last = lease.info().sequence;
  }
  const CaptureCounters counters = source->counters();
  EXPECT_EQ(last, frames_.back().info.sequence);
  EXPECT_EQ(counters.received, 100u);
  EXPECT_EQ(counters.received, counters.skipped + taken);
  EXPECT_GT(counters.skipped, 0u);
}

TEST_F(RecordingSourceTest, PacedFramesAreNeverEarlyAndLookAsIfSeenNow) {
  ASSERT_NO_FATAL_FAILURE(make_take(12));
  const std::int64_t before = mono_now_ns();
  const auto source = start(2);
  ASSERT_TRUE(source);
  EXPECT_DOUBLE_EQ(source->rate_hz(), 120);
  std::int64_t first_received = 0;
  while (const FrameLease lease = next(*source)) {
    const FrameInfo& info = lease.info();
    const TakeFrame& recorded = frames_.at(info.sequence - 1000);
    EXPECT_GE(info.received_mono_ns, before);
    EXPECT_LE(info.received_mono_ns, mono_now_ns());
    EXPECT_EQ(info.received_mono_ns - info.capture_mono_ns,
              recorded.info.received_mono_ns - recorded.info.capture_mono_ns);
    EXPECT_TRUE(same_codes(lease, recorded));
    EXPECT_EQ(info.exposure_us, recorded.info.exposure_us);
    if (info.sequence == 1000) first_received = info.received_mono_ns;
    if (first_received != 0) {  // half of the recorded time since; each step is rounded to a nanosecond
      const auto expected = (recorded.info.capture_mono_ns - frames_[0].info.capture_mono_ns) / 2;
      EXPECT_NEAR(static_cast<double>(info.received_mono_ns - first_received), static_cast<double>(expected),
                  12.0);
    }
  }
  EXPECT_TRUE(ended(*source));
}

TEST_F(RecordingSourceTest, LoopCountsOnWithoutRepeatingOrLosing) {
  ASSERT_NO_FATAL_FAILURE(make_take(7));
  const auto source = start(0, true);
  ASSERT_TRUE(source);
  std::int64_t last_capture = 0;
  for (std::uint64_t i = 0; i < 50; ++i) {
    const FrameLease lease = next(*source);
    ASSERT_TRUE(lease);
    EXPECT_EQ(lease.info().sequence, 1000 + i);
    EXPECT_GT(lease.info().capture_mono_ns, last_capture);
    last_capture = lease.info().capture_mono_ns;
    EXPECT_TRUE(same_codes(lease, frames_[i % 7]));
  }
  EXPECT_EQ(source->state(), SourceState::streaming);
  EXPECT_EQ(source->counters().lost, 0u);
}

TEST_F(RecordingSourceTest, GapsInTheSequenceAreLostFrames) {
  frames_ = test::take_frames(kFormat, 4);
  frames_[2].info.sequence += 5;
  frames_[3].info.sequence += 5;
  ASSERT_NO_FATAL_FAILURE(test::write_take(file_, test::take_header(kFormat, RecordingCodec::ffv1), frames_));
  const auto source = start(0);
  ASSERT_TRUE(source);
  while (next(*source)) continue;
  EXPECT_EQ(source->counters().lost, 5u);
}

TEST_F(RecordingSourceTest, LeasesOutliveStopAndStopNeedsNoReader) {
  ASSERT_NO_FATAL_FAILURE(make_take(50));
  const auto source = start(0);
  ASSERT_TRUE(source);
  const FrameLease lease = next(*source);
  ASSERT_TRUE(lease);
  source->stop();
  EXPECT_TRUE(same_codes(lease, frames_[0]));
  EXPECT_FALSE(source->wait(0ms));
}

TEST_F(RecordingSourceTest, StartAfterStopPlaysFromTheBeginning) {
  ASSERT_NO_FATAL_FAILURE(make_take(10));
  const auto source = start(0);
  ASSERT_TRUE(source);
  ASSERT_TRUE(next(*source));
  ASSERT_TRUE(next(*source));
  source->stop();
  ASSERT_TRUE(source->start());
  for (const TakeFrame& expected : frames_) {
    const FrameLease lease = next(*source);
    ASSERT_TRUE(lease);
    EXPECT_TRUE(test::same_bits(info_of(lease), expected.info));
  }
  EXPECT_FALSE(next(*source));
}

TEST_F(RecordingSourceTest, ACutTakePlaysItsWholeFramesAndSaysSo) {
  ASSERT_NO_FATAL_FAILURE(make_take(40));
  const std::string bytes = test::file_bytes(file_);
  test::write_bytes(file_, bytes.substr(0, bytes.size() / 2));
  const auto source = start(0);
  ASSERT_TRUE(source);
  std::size_t count = 0;
  while (const FrameLease lease = next(*source)) EXPECT_TRUE(same_codes(lease, frames_[count++]));
  EXPECT_GT(count, 10u);
  EXPECT_LT(count, 40u);
  EXPECT_TRUE(ended(*source));
  EXPECT_NE(source->describe().find("cut"), std::string::npos) << source->describe();
}

TEST_F(RecordingSourceTest, MissingFileAndBadOptionsAreRefused) {
  EXPECT_EQ(make_recording_source((folder_.path() / "absent.mkv").string(), {}).error().kind,
            ErrorKind::bad_input);
  ASSERT_NO_FATAL_FAILURE(make_take(1));
  CaptureOptions options;
  options.speed = -1;
  EXPECT_EQ(make_recording_source(file_, options).error().kind, ErrorKind::usage);
  options.speed = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(make_recording_source(file_, options).error().kind, ErrorKind::usage);
  options.speed = 1;
  options.buffers = 2;
  EXPECT_EQ(make_recording_source(file_, options).error().kind, ErrorKind::usage);
}

TEST(RecordedTimes, WildTimesArePlayedAtTheTakesRate) {
  RecordedTimes times(1, 100);
  RecordedFrame frame;
  const auto due = [&](std::int64_t capture) {
    frame.capture_mono_ns = capture;
    return times.play(frame).due_mono_ns;
  };
  constexpr std::int64_t kPeriod = 10'000'000;
  const std::int64_t first = due(std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(due(std::numeric_limits<std::int64_t>::min() + 1'000'000'000'000'000) - first, kPeriod);
  EXPECT_EQ(due(0) - first, 2 * kPeriod);
  EXPECT_EQ(due(-5) - first, 3 * kPeriod);
  EXPECT_EQ(due(95) - first, 3 * kPeriod + 100);
}

}  // namespace
}  // namespace lightwell
