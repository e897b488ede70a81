// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Independent programs read our takes.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "interface/recording.h"
#include "tests/support/takes.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

struct Outcome {
  int code = -1;
  std::string text;
};

Outcome shell(const std::string& command) {
  Outcome outcome;
  FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return outcome;
  std::array<char, 4096> buffer{};
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
    outcome.text.append(buffer.data(), n);
  const int status = ::pclose(pipe);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

bool missing(const std::string& program) {
  return shell("command -v " + program).code != 0;
}

class TakeInOtherPrograms : public testing::TestWithParam<RecordingCodec> {
 protected:
  void SetUp() override {
    const FrameFormat format{64, 48, PixelFormat::mono12};
    ASSERT_NO_FATAL_FAILURE(
        test::write_take(file_, test::take_header(format, GetParam()), test::take_frames(format, 12), 5));
  }
  [[nodiscard]] std::string quoted() const { return "'" + file_.string() + "'"; }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "take.mkv";
};

TEST_P(TakeInOtherPrograms, MkvmergeSeesTrackAndAttachmentWithoutWarning) {
  if (missing("mkvmerge")) GTEST_SKIP() << "mkvmerge (package mkvtoolnix) is not installed";
  const Outcome seen = shell("mkvmerge -J " + quoted());
  EXPECT_EQ(seen.code, 0) << seen.text;
  EXPECT_NE(seen.text.find("\"calibration.json\""), std::string::npos) << seen.text;
  EXPECT_NE(seen.text.find("\"64x48\""), std::string::npos) << seen.text;
  EXPECT_NE(seen.text.find("\"errors\": []"), std::string::npos) << seen.text;
  EXPECT_NE(seen.text.find("\"warnings\": []"), std::string::npos) << seen.text;
}

TEST_P(TakeInOtherPrograms, MkvinfoFindsARecordBesideEveryFrame) {
  if (missing("mkvinfo")) GTEST_SKIP() << "mkvinfo (package mkvtoolnix) is not installed";
  const Outcome seen = shell("LC_ALL=C mkvinfo --all " + quoted());
  EXPECT_EQ(seen.code, 0) << seen.text;
  std::size_t records = 0;
  for (std::size_t at = 0; (at = seen.text.find("Block additional: length 76, data: 0x4c 0x57 0x46 0x31",
                                                at)) != std::string::npos;
       ++at)
    ++records;
  EXPECT_EQ(records, 12u) << seen.text;
}

TEST_P(TakeInOtherPrograms, FfprobeCountsAndDecodesEveryFrame) {
  if (missing("ffprobe")) GTEST_SKIP() << "ffprobe (package ffmpeg) is not installed";
  const Outcome seen = shell(
      "ffprobe -v error -count_frames -select_streams v -show_entries "
      "stream=width,height,pix_fmt,nb_read_frames "
      "-of csv=p=0 " +
      quoted());
  EXPECT_EQ(seen.code, 0) << seen.text;
  EXPECT_EQ(seen.text, "64,48,gray12le,12\n");
}

std::string codec_name(const testing::TestParamInfo<RecordingCodec>& info) {
  return std::string(name(info.param));
}
INSTANTIATE_TEST_SUITE_P(Both, TakeInOtherPrograms,
                         testing::Values(RecordingCodec::raw, RecordingCodec::ffv1), codec_name);

}  // namespace
}  // namespace lightwell
