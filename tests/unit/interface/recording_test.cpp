// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/recording.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "tests/support/takes.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

using test::Codes;
using test::read_all;
using test::TakeFrame;
using test::TemporaryFolder;

// Odd ones: a half byte left over in packed formats, pictures smaller than a coder's block.
constexpr std::array<std::pair<int, int>, 5> kSizes = {{{1, 1}, {2, 9}, {3, 5}, {8, 3}, {641, 479}}};

class RecordingOf : public testing::TestWithParam<std::tuple<PixelFormat, RecordingCodec>> {
 protected:
  // change: what is done to the last frame's codes before it is written.
  template <class Change>
  static void expect_round_trip(std::uint32_t count, Change change) {
    const auto [pixel_format, codec] = GetParam();
    for (const auto& [width, height] : kSizes) {
      SCOPED_TRACE(std::to_string(width) + "x" + std::to_string(height));
      const FrameFormat format{width, height, pixel_format};
      auto frames = test::take_frames(format, count);
      change(frames.back().codes);
      const TemporaryFolder folder;
      const auto file = folder.path() / "take.mkv";
      ASSERT_NO_FATAL_FAILURE(test::write_take(file, test::take_header(format, codec), frames));
      auto reader = RecordingReader::open(file);
      ASSERT_TRUE(reader) << reader.error().message;
      const auto take = read_all(**reader);
      EXPECT_TRUE(take.complaints.empty()) << take.complaints.front().message;
      ASSERT_EQ(take.frames.size(), frames.size());
      for (std::size_t i = 0; i < frames.size(); ++i)
        EXPECT_TRUE(same(take.frames[i], frames[i])) << "frame " << i;
    }
  }
};

TEST_P(RecordingOf, FramesComeBackBitForBit) {
  expect_round_trip(3, [](Codes&) {});
}

// A camera that sets bits it should not, padding bits included: what came is what is kept.
TEST_P(RecordingOf, CodesBeyondTheFormatsRangeComeBackBitForBit) {
  expect_round_trip(2, [](Codes& codes) { std::fill(codes.begin(), codes.end(), std::byte{0xff}); });
}

TEST_P(RecordingOf, BlackFramesComeBackBitForBit) {
  expect_round_trip(1, [](Codes& codes) { std::fill(codes.begin(), codes.end(), std::byte{0}); });
}

std::string case_name(const testing::TestParamInfo<RecordingOf::ParamType>& info) {
  const auto [pixel_format, codec] = info.param;
  return std::string(name(pixel_format)) + "_" + std::string(name(codec));
}

INSTANTIATE_TEST_SUITE_P(EveryFormat, RecordingOf,
                         testing::Combine(testing::Values(PixelFormat::mono8, PixelFormat::mono10,
                                                          PixelFormat::mono12, PixelFormat::mono12p,
                                                          PixelFormat::mono16, PixelFormat::bayer_rg8,
                                                          PixelFormat::bayer_rg12, PixelFormat::bayer_rg16),
                                          testing::Values(RecordingCodec::raw, RecordingCodec::ffv1)),
                         case_name);

constexpr FrameFormat kSmall{16, 9, PixelFormat::mono12};

std::unique_ptr<RecordingReader> open_take(const std::filesystem::path& file) {
  auto reader = RecordingReader::open(file);
  EXPECT_TRUE(reader) << reader.error().message;
  return reader ? std::move(*reader) : nullptr;
}

TEST(Recording, ExtremePerFrameValuesComeBackBitForBit) {
  using I64 = std::numeric_limits<std::int64_t>;
  auto frames = test::take_frames(kSmall, 4);
  frames[0].info = {.sequence = std::numeric_limits<std::uint64_t>::max() - 1,
                    .capture_mono_ns = I64::min(),
                    .received_mono_ns = I64::max(),
                    .capture_utc_ns = -1,
                    .exposure_us = std::numeric_limits<double>::denorm_min(),
                    .gain_db = -0.0,
                    .temperature_c = std::numeric_limits<float>::quiet_NaN(),
                    .timecode = Timecode{23, 59, 59, 59, true}};
  frames[1].info = {.sequence = std::numeric_limits<std::uint64_t>::max(),
                    .capture_mono_ns = I64::max(),
                    .received_mono_ns = I64::min(),
                    .capture_utc_ns = I64::min(),
                    .exposure_us = std::numeric_limits<double>::infinity(),
                    .gain_db = std::bit_cast<double>(0x7ff0dead0000beefULL),  // a NaN with a payload
                    .temperature_c = -std::numeric_limits<float>::infinity(),
                    .timecode = Timecode{}};
  const TemporaryFolder folder;
  for (const RecordingCodec codec : {RecordingCodec::raw, RecordingCodec::ffv1}) {
    const auto file = folder.path() / (std::string(name(codec)) + ".mkv");
    ASSERT_NO_FATAL_FAILURE(test::write_take(file, test::take_header(kSmall, codec), frames));
    const auto reader = open_take(file);
    ASSERT_TRUE(reader);
    const auto take = read_all(*reader);
    EXPECT_TRUE(take.complaints.empty());
    ASSERT_EQ(take.frames.size(), frames.size());
    for (std::size_t i = 0; i < frames.size(); ++i)
      EXPECT_TRUE(same(take.frames[i], frames[i])) << "frame " << i;
  }
}

TEST(Recording, HeaderAndCalibrationComeBackExactly) {
  const TemporaryFolder folder;
  RecordingHeader header = test::take_header({31, 17, PixelFormat::bayer_rg12}, RecordingCodec::raw);
  header.rate_hz = 60000.0 / 1001.0;
  header.source = "aravis:127.0.0.1 \"<& é";
  header.calibration_json = "{\"text\": \"" + std::string(100'000, 'x') + "\"}\n";
  ASSERT_NO_FATAL_FAILURE(
      test::write_take(folder.path() / "a.mkv", header, test::take_frames(header.format, 1)));
  const auto reader = open_take(folder.path() / "a.mkv");
  ASSERT_TRUE(reader);
  const RecordingHeader& read = reader->header();
  EXPECT_EQ(read.format, header.format);
  EXPECT_EQ(read.codec, header.codec);
  EXPECT_EQ(read.rate_hz, header.rate_hz);
  EXPECT_EQ(read.source, header.source);
  EXPECT_EQ(read.calibration_json, header.calibration_json);
  EXPECT_EQ(read.start_utc_ns, header.start_utc_ns);
}

TEST(Recording, WithoutCalibrationSourceOrRateIsReadAsSuch) {
  const TemporaryFolder folder;
  const RecordingHeader header{.format = kSmall,
                               .codec = RecordingCodec::raw,
                               .rate_hz = 0,
                               .source = "",
                               .calibration_json = "",
                               .start_utc_ns = 0};
  ASSERT_NO_FATAL_FAILURE(test::write_take(folder.path() / "a.mkv", header, test::take_frames(kSmall, 2)));
  const auto reader = open_take(folder.path() / "a.mkv");
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->header().calibration_json, "");
  EXPECT_EQ(reader->header().source, "");
  EXPECT_EQ(reader->header().rate_hz, 0);
}

TEST(Recording, CountsFramesRewindsAndSkips) {
  const TemporaryFolder folder;
  const auto frames = test::take_frames(kSmall, 500);
  const auto file = folder.path() / "a.mkv";
  ASSERT_NO_FATAL_FAILURE(
      test::write_take(file, test::take_header(kSmall, RecordingCodec::ffv1), frames, 100));
  const auto reader = open_take(file);
  ASSERT_TRUE(reader);
  EXPECT_TRUE(reader->complete());
  EXPECT_EQ(reader->frame_count().value(), 500u);
  EXPECT_EQ(read_all(*reader).frames.size(), 500u);
  ASSERT_TRUE(reader->rewind());
  for (std::size_t i = 0; i < 250; ++i) {
    const auto skipped = reader->skip();
    ASSERT_TRUE(skipped && *skipped);
    EXPECT_TRUE(test::same_bits(**skipped, frames[i].info));
  }
  const auto rest = read_all(*reader);
  ASSERT_EQ(rest.frames.size(), 250u);
  EXPECT_TRUE(same(rest.frames[0], frames[250]));
}

TEST(Recording, EqualFramesMakeEqualFiles) {
  const TemporaryFolder folder;
  const auto header = test::take_header(kSmall, RecordingCodec::ffv1);
  const auto frames = test::take_frames(kSmall, 20);
  ASSERT_NO_FATAL_FAILURE(test::write_take(folder.path() / "a.mkv", header, frames, 10));
  ASSERT_NO_FATAL_FAILURE(test::write_take(folder.path() / "b.mkv", header, frames, 10));
  EXPECT_EQ(test::file_bytes(folder.path() / "a.mkv"), test::file_bytes(folder.path() / "b.mkv"));
}

TEST(Recording, BytesIsTheSizeOfTheFile) {
  const TemporaryFolder folder;
  auto writer =
      RecordingWriter::create(folder.path() / "a.mkv", test::take_header(kSmall, RecordingCodec::raw));
  ASSERT_TRUE(writer);
  for (const auto& frame : test::take_frames(kSmall, 10))
    ASSERT_TRUE((*writer)->write(frame.info, frame.codes));
  EXPECT_GE((*writer)->bytes(), 10 * kSmall.bytes());
  ASSERT_TRUE((*writer)->close());
  EXPECT_EQ((*writer)->bytes(), std::filesystem::file_size(folder.path() / "a.mkv"));
}

// Lossless coding that does not make a smooth picture smaller would be pointless.
TEST(Recording, Ffv1MakesASmoothPictureSmallerThanHalf) {
  const TemporaryFolder folder;
  const FrameFormat format{640, 480, PixelFormat::mono12};
  TakeFrame frame = test::take_frame(format, 0);
  for (int y = 0; y < format.height; ++y)
    for (int x = 0; x < format.width; ++x) {
      const auto code = static_cast<unsigned>(2000 + 900 * std::sin(x / 90.0) * std::cos(y / 70.0));
      const auto at = 2 * static_cast<std::size_t>(y * format.width + x);
      frame.codes[at] = static_cast<std::byte>(code & 0xff);
      frame.codes[at + 1] = static_cast<std::byte>(code >> 8);
    }
  const auto file = folder.path() / "a.mkv";
  ASSERT_NO_FATAL_FAILURE(test::write_take(file, test::take_header(format, RecordingCodec::ffv1), {frame}));
  EXPECT_LT(std::filesystem::file_size(file), format.bytes() / 2);
}

TEST(Recording, NeverOverwrites) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.mkv";
  test::write_bytes(file, "precious");
  const auto writer = RecordingWriter::create(file, test::take_header(kSmall, RecordingCodec::raw));
  ASSERT_FALSE(writer);
  EXPECT_EQ(writer.error().kind, ErrorKind::failed);
  EXPECT_NE(writer.error().message.find(file.string()), std::string::npos);
  EXPECT_EQ(test::file_bytes(file), "precious");
}

TEST(Recording, MissingFolderIsAFailureThatNamesTheFile) {
  const auto writer =
      RecordingWriter::create("/nonexistent/a.mkv", test::take_header(kSmall, RecordingCodec::raw));
  ASSERT_FALSE(writer);
  EXPECT_EQ(writer.error().kind, ErrorKind::failed);
  EXPECT_NE(writer.error().message.find("/nonexistent/a.mkv"), std::string::npos);
}

TEST(Recording, RefusesSizesOutOfRangeAndLeavesNoFile) {
  const TemporaryFolder folder;
  for (const int width : {0, -1, 16385}) {
    const auto writer = RecordingWriter::create(
        folder.path() / "a.mkv", test::take_header({width, 4, PixelFormat::mono8}, RecordingCodec::ffv1));
    ASSERT_FALSE(writer);
    EXPECT_EQ(writer.error().kind, ErrorKind::usage);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Recording, WhatIsNoTakeIsBadInputThatNamesTheFile) {
  const TemporaryFolder folder;
  test::write_bytes(folder.path() / "empty", "");
  test::write_bytes(folder.path() / "text", "Matroska, honestly");
  const auto take = folder.path() / "take.mkv";
  ASSERT_NO_FATAL_FAILURE(
      test::write_take(take, test::take_header(kSmall, RecordingCodec::raw), test::take_frames(kSmall, 1)));
  const std::string bytes = test::file_bytes(take);
  const std::size_t cluster = bytes.find("\x1f\x43\xb6\x75");  // the first: all before it is header
  ASSERT_NE(cluster, std::string::npos);
  test::write_bytes(folder.path() / "no-frames.mkv", bytes.substr(0, cluster));
  for (const char* file : {"missing", "", "empty", "text", "no-frames.mkv"}) {
    const auto path = folder.path() / file;
    const auto reader = RecordingReader::open(path);
    ASSERT_FALSE(reader) << file;
    EXPECT_EQ(reader.error().kind, ErrorKind::bad_input) << file;
    EXPECT_NE(reader.error().message.find(path.string()), std::string::npos) << reader.error().message;
  }
}

}  // namespace
}  // namespace lightwell
