// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// lightwell info, repair and record.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/command.h"
#include "interface/recording.h"
#include "tests/support/takes.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::cli {
namespace {

struct Outcome {
  int code = -1;
  std::string out, err;
};

Outcome run(std::vector<std::string> arguments) {
  CLI::App app;
  const auto commands = add_commands(app);
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  Outcome outcome;
  std::reverse(arguments.begin(), arguments.end());  // what CLI11 expects of a vector
  try {
    app.parse(arguments);
    for (const auto& command : commands)
      if (command.app->parsed()) outcome.code = command.run();
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "lightwell: %s\n", error.what());  // as main does
    outcome.code = 2;
  }
  outcome.out = testing::internal::GetCapturedStdout();
  outcome.err = testing::internal::GetCapturedStderr();
  return outcome;
}

class TakesCommand : public testing::Test {
 protected:
  void SetUp() override {
    frames_[5].info.sequence += 3;
    for (std::size_t i = 6; i < frames_.size(); ++i) frames_[i].info.sequence += 3;
    auto header = test::take_header(format_, RecordingCodec::raw);
    header.calibration_json.clear();
    ASSERT_NO_FATAL_FAILURE(test::write_take(take_, header, frames_, 10));
  }
  static void expect_one_line(const Outcome& outcome, int code, const std::string& says) {
    EXPECT_EQ(outcome.code, code) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_NE(outcome.err.find(says), std::string::npos) << outcome.err;
  }

  test::TemporaryFolder folder_;
  FrameFormat format_{33, 21, PixelFormat::mono12p};
  std::vector<test::TakeFrame> frames_ = test::take_frames(format_, 60);
  std::filesystem::path take_ = folder_.path() / "take.mkv";
};

TEST_F(TakesCommand, InfoSaysWhatTheTakeHolds) {
  const Outcome outcome = run({"info", take_.string(), "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json.at("frames"), 60);
  EXPECT_EQ(json.at("size"), nlohmann::json({33, 21}));
  EXPECT_EQ(json.at("format"), "Mono12p");
  EXPECT_EQ(json.at("codec"), "raw");
  EXPECT_EQ(json.at("rate_hz"), 60);
  EXPECT_NEAR(json.at("duration_s").get<double>(), 59 * 0.016666667, 1e-9);  // nanoseconds in a double
  EXPECT_EQ(json.at("lost_frames"), 3);
  EXPECT_EQ(json.at("complete"), true);
  EXPECT_TRUE(json.at("calibration_id").is_null());
  EXPECT_EQ(json.at("start_utc"), "2023-11-14T22:13:20.123Z");
}

TEST_F(TakesCommand, InfoOfACutTakeCountsItsWholeFramesAndSaysThatItIsCut) {
  const std::string bytes = test::file_bytes(take_);
  test::write_bytes(take_, bytes.substr(0, bytes.size() / 2));
  const Outcome outcome = run({"info", take_.string(), "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json.at("complete"), false);
  EXPECT_GT(json.at("frames"), 20);
  EXPECT_LT(json.at("frames"), 40);
  EXPECT_NE(outcome.err.find("cut"), std::string::npos);
}

TEST_F(TakesCommand, WhatIsNoTakeIsBadInputInOneLine) {
  expect_one_line(run({"info", (folder_.path() / "absent.mkv").string()}), 3, "absent.mkv");
  expect_one_line(run({"info", folder_.path().string(), "--json"}), 3, "directory");
  const auto out = folder_.path() / "out.mkv";
  expect_one_line(run({"repair", folder_.path().string(), "--out", out.string()}), 3, "directory");
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(TakesCommand, RepairMakesACompleteTake) {
  const std::string bytes = test::file_bytes(take_);
  const auto broken = folder_.path() / "broken.mkv", out = folder_.path() / "mended.mkv";
  test::write_bytes(broken, bytes.substr(0, bytes.size() / 2));
  const Outcome repaired = run({"repair", broken.string(), "--out", out.string(), "--json"});
  ASSERT_EQ(repaired.code, 0) << repaired.err;
  const auto recovered = nlohmann::json::parse(repaired.out).at("recovered");
  const auto info = nlohmann::json::parse(run({"info", out.string(), "--json"}).out);
  EXPECT_EQ(info.at("frames"), recovered);
  EXPECT_EQ(info.at("complete"), true);
  EXPECT_EQ(info.at("damage"), "");
  expect_one_line(run({"repair", broken.string(), "--out", out.string()}), 1, "exists");
  expect_one_line(run({"repair", broken.string(), "--out", "-"}), 2, "/dev/stdout");
  expect_one_line(run({"repair", broken.string(), "--out", "/nonexistent/a.mkv"}), 1, "/nonexistent/a.mkv:");
}

TEST_F(TakesCommand, RecordFromASourceKeepsItsFramesBitForBit) {
  const auto out = folder_.path() / "again.mkv";
  const Outcome outcome = run({"record", "--seconds", "20", "--out", out.string(), "--source",
                               "recording:" + take_.string(), "--codec", "ffv1", "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;  // long before the 20 s: the source ends
  const auto json = nlohmann::json::parse(outcome.out);
  auto reader = RecordingReader::open(out);
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_TRUE((*reader)->complete());
  EXPECT_EQ((*reader)->header().codec, RecordingCodec::ffv1);
  const auto again = test::read_all(**reader);
  EXPECT_EQ(json.at("frames"), again.frames.size());
  // A busy machine may skip frames of a paced source; those that are there are true.
  EXPECT_EQ(again.frames.size() + json.at("dropped").get<std::size_t>(), frames_.size());
  for (const auto& frame : again.frames) {
    const auto original = std::find_if(frames_.begin(), frames_.end(), [&](const test::TakeFrame& candidate) {
      return candidate.info.sequence == frame.info.sequence;
    });
    ASSERT_NE(original, frames_.end());
    EXPECT_EQ(frame.codes, original->codes);
    EXPECT_EQ(frame.info.exposure_us, original->info.exposure_us);
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 2);  // take and again
}

TEST_F(TakesCommand, RecordRefusesWhatCannotWorkBeforeAnyFrame) {
  const std::string source = "recording:" + take_.string();
  const std::string out = (folder_.path() / "out.mkv").string();
  expect_one_line(run({"record", "--seconds", "0", "--out", out, "--source", source}), 2, "--seconds");
  expect_one_line(run({"record", "--seconds", "nan", "--out", out, "--source", source}), 2, "--seconds");
  expect_one_line(run({"record", "--seconds", "1", "--out", "/nonexistent/a.mkv", "--source", source}), 1,
                  "/nonexistent");
  expect_one_line(run({"record", "--seconds", "1", "--out", take_.string(), "--source", source}), 2,
                  "is also the input");
  const std::string other = folder_.path().string();
  expect_one_line(run({"record", "--seconds", "1", "--out", other, "--source", source}), 1, "exists");
  expect_one_line(run({"record", "--seconds", "1", "--out", out, "--source", "magic:8"}), 2, "magic:8");
  expect_one_line(run({"record", "--seconds", "1", "--out", out, "--source", "recording:" + out}), 3,
                  "out.mkv");
  EXPECT_EQ(run({"record", "--seconds", "1", "--out", out, "--source", source, "--codec", "mp4"}).code, 2);
  expect_one_line(run({"record", "--seconds", "1", "--out", "-", "--source", source}), 2, "/dev/stdout");
  // A daemon's rule, said before it is asked; on its own the command writes under any name.
  for (const char* name : {"prüfung.mkv", "a/b\xff.mkv", "take.mp4", "-a.mkv"})
    expect_one_line(run({"record", "--seconds", "1", "--out", name}), 2,
                    "--out " + std::string(name) + ": the daemon takes plain names only");
  // Nobody listens on the discard port of an address of our own.
  expect_one_line(run({"record", "--seconds", "1", "--out", out, "--daemon", "127.83.11.5:9"}), 1,
                  "127.83.11.5:9");
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace lightwell::cli
