// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "interface/atomic_file.h"
#include "interface/calibration_io.h"
#include "interface/exr_file.h"
#include "interface/recording.h"
#include "tests/integration/commands/command_fixture.h"

namespace lightwell::test {
namespace {

using testing::HasSubstr;

const std::string kTake = LIGHTWELL_SOURCE_DIR "/tests/data/take.mkv";

class DevelopCommandTest : public CommandTest {
 protected:
  [[nodiscard]] ProcessResult develop(const std::string& input, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"develop", input};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return lightwell(arguments);
  }
  [[nodiscard]] LatLongImage picture(const std::string& name) const {
    const std::string bytes = *read_text_file(path(name));
    const auto image = read_exr(bytes, name, 1 << 24);
    EXPECT_TRUE(image) << (image ? "" : image.error().message);
    return image ? *image : LatLongImage{};
  }
  void expect_refused(const ProcessResult& result, int code, const std::string& text) const {
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_THAT(result.err, HasSubstr(text));
  }
  // Of the take's first frame: what it truly showed, lux summed over directions.
  static double truth() {
    std::ifstream file(LIGHTWELL_SOURCE_DIR "/tests/data/truth.jsonl");
    std::string line;
    std::getline(file, line);
    return nlohmann::json::parse(line).at("total_illuminance")[0];
  }
};

TEST_F(DevelopCommandTest, EveryFrameBecomesAPictureOfTheLightThatWasThere) {
  const auto done = develop(kTake, {"--out", path("frame_%06d.exr"), "--json"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(nlohmann::json::parse(done.out)["frames"], 31);
  EXPECT_TRUE(std::filesystem::exists(path("frame_000030.exr")));
  const LatLongImage image = picture("frame_000000.exr");
  ASSERT_EQ(image.width, 360);
  ASSERT_EQ(image.height, 180);
  double sum = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      sum += static_cast<double>(image.at(x, y)[1]) * image.pixel_solid_angle_sr(y);
  EXPECT_NEAR(sum / truth(), 1, 0.01);
  EXPECT_EQ(image.at(100, 170).maxCoeff(), 0) << "below the horizon";
  const std::string bytes = *read_text_file(path("frame_000000.exr"));
  EXPECT_EQ(**exr_text(bytes, "lightwell_projection", ""), "latlong");
  EXPECT_NEAR(std::stod(**exr_text(bytes, "lightwell_coverage", "")), 0.5, 1e-3);
}

TEST_F(DevelopCommandTest, OtherProjectionsAndSizesShowTheSame) {
  ASSERT_EQ(develop(kTake, {"--out", path("p_%d.exr"), "--projection", "polar", "--size", "90x30"}).exit_code,
            0);
  const LatLongImage polar = picture("p_0.exr");
  ASSERT_EQ(polar.width, 90);
  ASSERT_EQ(polar.height, 30);
  double sum = 0;
  const PolarGrid grid{30, 90, kPi / 2};
  for (int ring = 0; ring < 30; ++ring)
    for (int sector = 0; sector < 90; ++sector)
      sum += static_cast<double>(polar.at(sector, ring)[1]) * grid.bin_solid_angle_sr(ring);
  EXPECT_NEAR(sum / truth(), 1, 0.03) << "bins are as large as the camera's pixels";
  ASSERT_EQ(develop(kTake, {"--out", path("e_%d.exr"), "--projection", "fisheye"}).exit_code, 0);
  const LatLongImage fisheye = picture("e_0.exr");
  ASSERT_EQ(fisheye.width, 128);
  ASSERT_EQ(fisheye.height, 96);
  EXPECT_EQ(fisheye.at(0, 0).maxCoeff(), 0) << "a corner that the lens does not reach";
  EXPECT_GT(fisheye.at(64, 48).minCoeff(), 0);
  ASSERT_EQ(develop(kTake, {"--out", path("s_%d.exr"), "--size", "128x64"}).exit_code, 0);
  EXPECT_EQ(picture("s_0.exr").width, 128);
}

// The same codes from a grey map give the same picture as from the take.
TEST_F(DevelopCommandTest, ASingleFrameIsAGreyMap) {
  const auto reader = RecordingReader::open(kTake);
  ASSERT_TRUE(reader) << reader.error().message;
  std::vector<std::byte> codes((*reader)->header().format.bytes());
  const auto frame = (*reader)->read(codes);
  ASSERT_TRUE(frame && *frame);
  const auto calibration = calibration_from_json((*reader)->header().calibration_json, "take");
  ASSERT_TRUE(calibration);
  ASSERT_TRUE(write_calibration(path("cal"), *calibration));
  std::string text = "P5\n# a frame\n128 96\n4095\n";
  for (std::size_t i = 0; i < codes.size(); ++i) text += static_cast<char>(codes[i ^ 1]);
  ASSERT_TRUE(write_file_atomically(path("frame.pgm"), text));
  ASSERT_EQ(develop(path("frame.pgm"), {"--calibration", path("cal"), "--exposure",
                                        std::to_string((*frame)->exposure_us), "--out", path("one.exr")})
                .exit_code,
            0);
  ASSERT_EQ(develop(kTake, {"--out", path("t_%d.exr")}).exit_code, 0);
  const LatLongImage one = picture("one.exr"), first = picture("t_0.exr");
  ASSERT_EQ(one.pixels.size(), first.pixels.size());
  for (std::size_t i = 0; i < one.pixels.size(); ++i)
    ASSERT_TRUE((one.pixels[i] == first.pixels[i]).all()) << i;
  expect_refused(develop(path("frame.pgm"), {"--out", path("x.exr")}), 3, "no calibration");
  ASSERT_TRUE(write_file_atomically(path("frame.pgm"), text.substr(0, text.size() - 1)));
  expect_refused(develop(path("frame.pgm"), {"--calibration", path("cal"), "--out", path("x.exr")}), 3,
                 "bytes of samples, allowed: 24576");
}

TEST_F(DevelopCommandTest, WrongUsageIsOneLineAndLeavesNothing) {
  expect_refused(develop(kTake, {"--out", path("one.exr")}), 2, "a name with a number");
  expect_refused(develop(kTake, {"--out", path("f_%d.png")}), 2, "allowed: .exr");
  expect_refused(develop(kTake, {"--out", path("f_%d.exr"), "--projection", "cube"}), 2,
                 "--projection is cube, allowed: latlong, polar, fisheye");
  expect_refused(develop(kTake, {"--out", path("f_%d.exr"), "--size", "100x100"}), 2,
                 "twice as wide as high");
  expect_refused(develop(kTake, {"--out", path("f_%d.exr"), "--size", "big"}), 2, "allowed: WIDTHxHEIGHT");
  expect_refused(develop(kTake, {"--out", path("f_%d.exr"), "--exposure", "5"}), 2, "needs a single frame");
  expect_refused(develop(path("no.mkv"), {"--out", path("f_%d.exr")}), 3, "no.mkv");
  expect_refused(develop(kTake, {"--out", path("none/f_%d.exr")}), 1, "none");
  EXPECT_FALSE(std::filesystem::exists(path("f_0.exr")));
}

}  // namespace
}  // namespace lightwell::test
