// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "interface/atomic_file.h"
#include "interface/calibration_io.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

using nlohmann::json;
using test::ProcessResult;
using testing::HasSubstr;

const std::string kCamera =
    "cam0:\n  camera_model: pinhole\n  intrinsics: [285.5, 286.5, 421.25, 398.75]\n"
    "  distortion_model: equidistant\n  distortion_coeffs: [-0.0031, 0.0412, -0.0384, 0.0067]\n"
    "  resolution: [848, 800]\n";

// `lightwell calibrate import` and `orient`, whose output is lens.json.
class ImportCommand : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string file(const std::string& name, const std::string& text) const {
    EXPECT_TRUE(write_file_atomically(path(name), text));
    return path(name);
  }
  ProcessResult calibrate(std::vector<std::string> words) const {
    words.insert(words.begin(), "calibrate");
    words.insert(words.end(), {"--out", path("lens.json")});
    return test::run_process(LIGHTWELL_BIN_DIR "/lightwell", words);
  }
  void expect_refused(const std::vector<std::string>& words, int code, const std::string& names) const {
    ASSERT_TRUE(write_file_atomically(path("lens.json"), "before"));
    const ProcessResult run = calibrate(words);
    EXPECT_EQ(run.exit_code, code) << run.err;
    EXPECT_THAT(run.err, HasSubstr(names));
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(read_text_file(path("lens.json")).value(), "before");
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(ImportCommand, WritesTheLensWithTheConversionsError) {
  const std::string camera = file("camchain.yaml", kCamera);
  const ProcessResult run = calibrate({"import", camera, "--max-theta", "80", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const json report = json::parse(run.out);
  EXPECT_EQ(report["imported"]["format"], "kalibr");
  EXPECT_EQ(report["imported"]["model"], "pinhole-equidistant");
  EXPECT_EQ(report["imported"]["exact"], true);
  for (const char* key : {"rms_px", "max_px", "rms_deg", "max_deg", "max_at_deg", "directions", "weighting"})
    EXPECT_TRUE(report["imported"].contains(key)) << key;
  EXPECT_EQ(json::parse(read_text_file(path("lens.json")).value()), report);
  const auto lens = read_lens(path("lens.json"));
  ASSERT_TRUE(lens.ok()) << lens.error().message;
  EXPECT_EQ(lens->focal, Vec2d(285.5, 286.5));
  EXPECT_NEAR(lens->max_theta_rad, 80 * kPi / 180, 1e-12);
  const ProcessResult text = calibrate({"import", camera, "--format", "kalibr", "--camera", "cam0"});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("conversion        exact"));
}

TEST_F(ImportCommand, AProjectionThatStopsGrowingInsideTheImageIsSaidToEndTheField) {
  // 1 − 0.6 θ² falls to the least slope, 0.001, at 73.9 degrees; the image goes on.
  std::string folding = kCamera;
  folding.replace(folding.find("-0.0031, 0.0412, -0.0384, 0.0067"), 32, "-0.2, 0, 0, 0");
  const ProcessResult run = calibrate({"import", file("camchain.yaml", folding)});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("to 73.9 degrees off axis, where its projection stops growing"));
}

TEST_F(ImportCommand, AFieldBeyondTheImageIsExtrapolatedAndTheFileSaysFromWhere) {
  const std::string camera = file("camchain.yaml", kCamera);
  ASSERT_EQ(calibrate({"import", camera}).exit_code, 0);
  const double shown = json::parse(read_text_file(path("lens.json")).value())["max_theta_deg"];
  const ProcessResult run = calibrate({"import", camera, "--max-theta", std::to_string(shown + 5)});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  char says[80];
  std::snprintf(says, sizeof says, "extrapolated beyond %.1f, the farthest that the image shows", shown);
  EXPECT_THAT(run.out, HasSubstr(says));
  const json written = json::parse(read_text_file(path("lens.json")).value());
  EXPECT_NEAR(written["supported_theta_deg"], shown, 1e-9);
  EXPECT_NEAR(written["max_theta_deg"], shown + 5, 1e-5);  // six decimals of the option
  EXPECT_NEAR(read_lens(path("lens.json")).value().max_theta_rad * 180 / kPi, shown + 5, 1e-5);
}

TEST_F(ImportCommand, GravityOfAnImportIsReadInTheFilesCameraFrame) {
  const std::string camera = file("camchain.yaml", kCamera);
  ASSERT_EQ(calibrate({"import", camera, "--max-theta", "80", "--gravity", "1.7,-0.4,9.66"}).exit_code, 0);
  EXPECT_LT((read_lens(path("lens.json")).value().zenith - Vec3d(1.7, -0.4, 9.66).normalized()).norm(),
            1e-12);
}

TEST_F(ImportCommand, RefusesInOneLineAndWritesNothing) {
  const std::string camera = file("camchain.yaml", kCamera);
  expect_refused({"import", path("absent.yaml")}, 3, "absent.yaml");
  expect_refused({"import", file("bad.yaml", kCamera + "  : [")}, 3, "bad.yaml");
  expect_refused({"import", camera, "--camera", "cam9"}, 2, "cam0");
  expect_refused({"import", camera, "--format", "colmap"}, 2, "--format");
  expect_refused({"import", camera, "--max-theta", "181"}, 2, "--max-theta");
  std::string bent = kCamera;
  bent.replace(bent.find("[-0.0031, 0.0412, -0.0384, 0.0067]"), 34, "[-0.12, 0, 0, 0]");
  expect_refused({"import", file("bent.yaml", bent), "--max-theta", "100"}, 2, "allowed at most 95.");
  expect_refused({"import", camera, "--gravity", "0,0"}, 2, "--gravity");
  expect_refused({"import", camera, "--gravity", "0,0,-9.8"}, 2, "straight down");
}

TEST_F(ImportCommand, APerspectiveLensWithoutItsModelsNameIsRefused) {
  const std::string lens =
      file("webcam.yaml",
           "image_width: 640\nimage_height: 480\nK: [535.9, 0, 342.3, 0, 535.9, 235.6, 0, 0, 1]\n"
           "D: [-0.2664, -0.0386, 0.0018, -0.0003]\n");
  expect_refused({"import", lens}, 2, "webcam.yaml: names no lens model");
  expect_refused({"import", lens, "--model", "omnidir"}, 3, "webcam.yaml: xi is missing");
}

TEST_F(ImportCommand, AModelThatIsAssumedIsSaidInOneLineAndInTheFile) {
  const std::string lens =
      file("lens.yaml",
           "image_width: 848\nimage_height: 800\nK: [285.5, 0, 421.25, 0, 286.5, 398.75, 0, 0, "
           "1]\nD: [-0.0031, 0.0412, -0.0384, 0.0067]\n");
  const ProcessResult assumed = calibrate({"import", lens, "--max-theta", "80", "--json"});
  ASSERT_EQ(assumed.exit_code, 0) << assumed.err;
  EXPECT_THAT(assumed.err, HasSubstr("lens.yaml: names no lens model"));
  EXPECT_THAT(assumed.err, HasSubstr("--model fisheye"));
  EXPECT_EQ(std::count(assumed.err.begin(), assumed.err.end(), '\n'), 1) << assumed.err;
  EXPECT_EQ(json::parse(assumed.out)["imported"]["assumed"], "cv::fisheye");
  const ProcessResult stated =
      calibrate({"import", lens, "--model", "fisheye", "--max-theta", "80", "--json"});
  ASSERT_EQ(stated.exit_code, 0) << stated.err;
  EXPECT_EQ(stated.err, "");
  EXPECT_FALSE(json::parse(stated.out)["imported"].contains("assumed"));
}

TEST_F(ImportCommand, OrientKeepsWhatStandsInTheFileAndTurnsTheWorld) {
  const std::string camera = file("camchain.yaml", kCamera);
  ASSERT_EQ(calibrate({"import", camera, "--max-theta", "80"}).exit_code, 0);
  const json before = json::parse(read_text_file(path("lens.json")).value());
  // In place: the output may be the input.
  const ProcessResult run = calibrate({"orient", path("lens.json"), "--gravity", "-1.7,0,9.66", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NEAR(json::parse(run.out)["tilt_deg"], std::atan2(1.7, 9.66) * 180 / kPi, 1e-9);
  json after = json::parse(read_text_file(path("lens.json")).value());
  const auto lens = read_lens(path("lens.json"));
  ASSERT_TRUE(lens.ok()) << lens.error().message;
  EXPECT_LT((lens->zenith - Vec3d(-1.7, 0, 9.66).normalized()).norm(), 1e-12);
  EXPECT_EQ(after["schema"], "lightwell.lens/2");  // which readers that know no zenith refuse
  after.erase("zenith");
  after["schema"] = before["schema"];
  EXPECT_EQ(after, before);
  // Back to level: a file like that of a camera whose gravity was never known.
  ASSERT_EQ(calibrate({"orient", path("lens.json"), "--gravity", "0,0,1"}).exit_code, 0);
  EXPECT_EQ(json::parse(read_text_file(path("lens.json")).value()), before);
  expect_refused({"orient", file("none.json", "{}"), "--gravity", "0,0,1"}, 3, "none.json");
  expect_refused({"orient", path("absent.json"), "--gravity", "0,0,1"}, 3, "absent.json");
}

}  // namespace
}  // namespace lightwell
