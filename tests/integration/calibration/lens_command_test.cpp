// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "calibration/lens/lens_calibration.h"
#include "interface/atomic_file.h"
#include "interface/calibration_io.h"
#include "interface/jpeg.h"
#include "tests/support/babelcalib_corners.h"
#include "tests/support/board_views.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

using nlohmann::json;
using test::ProcessResult;
using testing::HasSubstr;

const std::filesystem::path kData = std::filesystem::path(LIGHTWELL_TEST_DATA) / "fisheye_cal";

class LensCommand : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  ProcessResult calibrate(std::vector<std::string> words) const {
    words.insert(words.begin(), {"calibrate", "lens"});
    words.insert(words.end(), {"--out", path("lens.json")});
    return test::run_process(LIGHTWELL_BIN_DIR "/lightwell", words);
  }
  // The code, one line that names what it must, and the file that was there before is as it was.
  void expect_refused(const std::vector<std::string>& words, int code, const std::string& names) const {
    ASSERT_TRUE(write_file_atomically(path("lens.json"), "before"));
    const ProcessResult run = calibrate(words);
    EXPECT_EQ(run.exit_code, code) << run.err;
    EXPECT_THAT(run.err, HasSubstr(names));
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(read_text_file(path("lens.json")).value(), "before");
    for (const auto& entry : std::filesystem::directory_iterator(path("")))  // no temporary is left
      EXPECT_EQ(entry.path().filename().string().find("lens.json."), std::string::npos) << entry.path();
  }
  // urban_fisheye1's pictures, empty where they are not here.
  static std::vector<std::string> urban() {
    std::vector<std::string> files;
    for (int i = 1; i <= 15; ++i) {
      const auto file = kData / "urban_fisheye1" / ("Fisheye1_" + std::to_string(i) + ".jpg");
      if (std::filesystem::exists(file)) files.push_back(file.string());
    }
    return files;
  }
  static std::vector<std::string> with(std::vector<std::string> files, const std::vector<std::string>& more) {
    files.insert(files.end(), more.begin(), more.end());
    return files;
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(LensCommand, UrbanFisheyeToThreeTenthsOfAPixelOnThirteenBoards) {
  const std::vector<std::string> files = urban();
  if (files.size() != 15) GTEST_SKIP() << "urban_fisheye1 is not in " << kData;
  const ProcessResult run = calibrate(with(files, {"--board", "6x8:32.5", "--json"}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json lens = json::parse(run.out);
  EXPECT_LE(lens["rms_px"], 0.30);           // OpenCV: 0.510 px on 10 boards
  EXPECT_LE(lens["held_out_rms_px"], 0.33);  // and not by fitting noise
  EXPECT_GE(
      std::count_if(lens["views"].begin(), lens["views"].end(), [](const json& v) { return v["used"]; }), 13);
  // The published centre, of another model, is a pixel's fraction away.
  EXPECT_NEAR(lens["center"][0], 543.99, 0.5);
  EXPECT_NEAR(lens["center"][1], 377.65, 0.5);
  EXPECT_TRUE(read_lens(path("lens.json")));
}

TEST_F(LensCommand, BabelCalibsCornersFromNoGuess) {
  const auto corners = kData / "babelcalib_ov_plane" / "corners";
  const auto train = test::babelcalib_corners(corners / "train");
  const auto held = test::babelcalib_corners(corners / "test");
  if (!train || !held) GTEST_SKIP() << "babelcalib_ov_plane is not in " << kData;
  ASSERT_TRUE(write_file_atomically(path("corners.json"), calibration::to_json(*train)));
  const ProcessResult run = calibrate({"--corners", path("corners.json"), "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json report = json::parse(run.out);
  EXPECT_LE(report["rms_px"], 0.57);
  EXPECT_EQ(report["views"].size(), 18u);
  const auto lens = read_lens(path("lens.json"));
  ASSERT_TRUE(lens.ok()) << lens.error().message;
  double sum = 0;
  std::size_t count = 0;
  for (const calibration::TargetView& view : held->views) {
    const calibration::ViewResult fit = calibration::fit_view(*lens, view);
    ASSERT_TRUE(fit.used) << view.name;
    for (const Vec2d& error : fit.residuals_px) sum += error.squaredNorm();
    count += fit.residuals_px.size();
  }
  EXPECT_LE(std::sqrt(sum / static_cast<double>(count)), 0.51);  // every point of the unseen views
}

TEST_F(LensCommand, RefusesPicturesOfAnotherBoardOrOfNone) {
  const std::vector<std::string> files = urban();
  if (files.size() != 15) GTEST_SKIP() << "urban_fisheye1 is not in " << kData;
  const std::vector<std::string> few(files.begin(), files.begin() + 5);
  expect_refused(with(few, {"--board", "5x7:32.5"}), 3, "more inner corners");
  expect_refused({files[0], "--board", "7x8:32.5"}, 3, "7x8 chessboard");
  expect_refused(with(few, {"--board", "9x6:32.5"}), 3, "shows a chessboard of");
  ASSERT_TRUE(write_file_atomically(path("copy.jpg"), read_text_file(files[0]).value()));
  expect_refused(with(few, {path("copy.jpg"), "--board", "6x8:32.5"}), 3, "is the same picture as");
  expect_refused(with({files[0], files[1]}, {"--board", "6x8:32.5"}), 3, "2 views");
  expect_refused(with({files[0], files[0], files[1]}, {"--board", "6x8:32.5"}), 3, "twice");
  const auto other = kData / "ocam_matsuren" / "img0.jpg";
  if (std::filesystem::exists(other))
    expect_refused(with(few, {other.string(), "--board", "6x8:32.5"}), 3, "img0.jpg");
  const std::string whole = read_text_file(files[2]).value();
  ASSERT_TRUE(write_file_atomically(path("cut.jpg"), whole.substr(0, whole.size() / 2)));
  expect_refused(with(few, {path("cut.jpg"), "--board", "6x8:32.5"}), 3, "cut.jpg");
}

TEST_F(LensCommand, WrongUsageIsOneLine) {
  expect_refused({}, 2, "--corners");
  expect_refused({"a.png"}, 2, "--board");
  expect_refused({"--corners", "a.json", "b.png", "--board", "6x8:30"}, 2, "together");
  expect_refused({"--corners", "a.json", "--board", "6x8:30"}, 2, "--board");
  for (const char* board :
       {"", "6x8", "6:30", "6x8:0", "6x8:-3", "6x8:nan", "1x8:30", "6x8:30:circles", "6x8:30x", "2x2:3"})
    expect_refused({"a.png", "--board", board}, 2, "--board");
  expect_refused({"a.png", "--board", "6x8:30:charuco", "--marker", "30"}, 2, "--marker");
  expect_refused({"a.png", "--board", "6x8:30:charuco", "--marker", "0"}, 2, "--marker");
  expect_refused({"a.png", "--board", "6x8:30", "--marker", "20"}, 2, "--marker goes with");
  expect_refused({"--corners", "a.json", "--marker", "20"}, 2, "--marker goes with");
  expect_refused({"--corners", "a.json", "--corners-out", ""}, 2, "--corners-out");
  // Before anything is read or solved.
  expect_refused({"--corners", path("absent.json"), "--gravity", "0,0"}, 2, "--gravity");
}

TEST_F(LensCommand, BadFilesAreNamed) {
  ASSERT_TRUE(write_file_atomically(path("text.png"), "no picture"));
  expect_refused({path("absent.png"), "--board", "6x8:30"}, 3, "absent.png");
  expect_refused({path("text.png"), "--board", "6x8:30"}, 3, "text.png");
  expect_refused({path(""), "--board", "6x8:30"}, 3, path(""));
  ASSERT_TRUE(write_file_atomically(path("bad.json"),
                                    "{\"image_size\":[640,480],\"views\":[{\"points\":[[0,0,0,NaN,1]]}]}"));
  expect_refused({"--corners", path("bad.json")}, 3, "bad.json");
  expect_refused({"--corners", path("absent.json")}, 3, "absent.json");
  EXPECT_EQ(calibrate({"--corners", path("bad.json")}).err,
            "lightwell: " + path("bad.json") +
                ": line 1: is not JSON from 'NaN,1]]}]}' on\n");  // our words, not the library's
  ASSERT_TRUE(write_file_atomically(path("none.json"), "{\"image_size\":[640,480],\"views\":[]}"));
  expect_refused({"--corners", path("none.json")}, 3, "0 views");
}

TEST_F(LensCommand, BrokenPicturesAreNamed) {
  const std::vector<std::string> files = urban();
  if (files.size() != 15) GTEST_SKIP() << "urban_fisheye1 is not in " << kData;
  ASSERT_TRUE(write_file_atomically(path("empty.jpg"), ""));
  expect_refused({files[0], path("empty.jpg"), "--board", "6x8:32.5"}, 3, "empty.jpg");
  // The first bytes of a PNG file with a header of 64 x 64 and nothing behind it.
  ASSERT_TRUE(write_file_atomically(
      path("cut.png"), std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x40\0\0\0\x40\x08\0\0\0\0", 29)));
  expect_refused({files[0], path("cut.png"), "--board", "6x8:32.5"}, 3,
                 "cut.png: is no PNG picture: its header is damaged\n");
  expect_refused({files[0], kData.string(), "--board", "6x8:32.5"}, 3, kData.string());
  std::vector<std::uint8_t> grey(3 * 64 * 48, 128);
  ASSERT_TRUE(write_file_atomically(path("small.jpg"), encode_jpeg(64, 48, grey, 90).value()));
  expect_refused({files[0], path("small.jpg"), "--board", "6x8:32.5"}, 3,
                 "small.jpg: has 64x48 pixels, allowed");
}

TEST_F(LensCommand, ViewsThatCannotTellALensAreRefusedByReason) {
  const Lens lens{{640, 640}, {180, 180}, {330, 310}, {0, 0, 0, 0}, kPi / 2};
  test::BoardSetup setup;
  setup.views = 8;
  setup.columns = setup.rows = 6;
  const auto refused = [&](const test::BoardSetup& views, const std::string& names) {
    ASSERT_TRUE(write_file_atomically(path("views.json"),
                                      calibration::to_json(test::board_views(lens, views).target_views)));
    expect_refused({"--corners", path("views.json")}, 3, names);
  };
  test::BoardSetup few = setup;
  few.views = 2;
  refused(few, "2 views");
  test::BoardSetup central = setup;  // 60 mm of board 2 m away, all within 2 degrees of the axis
  central.pitch_mm = 12;
  central.distance_mm = 2000;
  central.field_rad = 0.03;
  refused(central, "centre");
  // One board moved straight toward the camera: far with a long focal length looks as near with a short one.
  calibration::TargetViews parallel{lens.image_size, {}};
  for (const double distance : {300.0, 400.0, 500.0}) {
    calibration::TargetView view{"at " + std::to_string(distance), {}};
    for (int r = 0; r < 6; ++r)
      for (int c = 0; c < 6; ++c) {
        const Vec3d p(30.0 * (c - 2.5), 30.0 * (r - 2.5), 0);
        view.points.push_back({p, lens.project(p + Vec3d(0, 0, distance))});
      }
    parallel.views.push_back(view);
  }
  ASSERT_TRUE(write_file_atomically(path("parallel.json"), calibration::to_json(parallel)));
  expect_refused({"--corners", path("parallel.json")}, 3, "parallel");
}

TEST_F(LensCommand, ANumberOutOfRangeIsOneLineWithItsPlace) {
  const Lens lens{{640, 640}, {180, 180}, {330, 310}, {0, 0, 0, 0}, kPi / 2};
  auto views = test::board_views(lens, {}).target_views;
  views.views[2].points[3].target_mm.x() = 1e300;
  ASSERT_TRUE(write_file_atomically(path("far.json"), calibration::to_json(views)));
  expect_refused({"--corners", path("far.json")}, 3, "views[2].points[3][0] = 1e+300: allowed");
}

TEST_F(LensCommand, BothOutputsAreWrittenOrNeither) {
  const Lens lens{{640, 640}, {180, 180}, {330, 310}, {0, 0, 0, 0}, kPi / 2};
  ASSERT_TRUE(
      write_file_atomically(path("in.json"), calibration::to_json(test::board_views(lens, {}).target_views)));
  expect_refused({"--corners", path("in.json"), "--corners-out", path("absent/corners.json")}, 1, "absent");
  expect_refused({"--corners", path("in.json"), "--corners-out", path("lens.json")}, 2, "--corners-out");
  const ProcessResult run = test::run_process(
      LIGHTWELL_BIN_DIR "/lightwell", {"calibrate", "lens", "--corners", path("in.json"), "--corners-out",
                                       path("corners.json"), "--out", path("absent/lens.json")});
  EXPECT_EQ(run.exit_code, 1) << run.err;
  EXPECT_FALSE(std::filesystem::exists(path("corners.json")));
  ASSERT_EQ(calibrate({"--corners", path("in.json"), "--corners-out", path("corners.json")}).exit_code, 0);
  EXPECT_EQ(read_text_file(path("corners.json")).value(), read_text_file(path("in.json")).value());
}

TEST_F(LensCommand, APictureWithANameThatIsNotUtf8Counts) {
  std::vector<std::string> files = urban();
  if (files.size() != 15) GTEST_SKIP() << "urban_fisheye1 is not in " << kData;
  std::filesystem::copy_file(files[0], path("\xff.jpg"));
  files[0] = path("\xff.jpg");
  const ProcessResult run = calibrate(with(files, {"--board", "6x8:32.5", "--json"}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(json::parse(run.out)["views"][0]["name"].get<std::string>(), HasSubstr("\xEF\xBF\xBD"));
}

TEST_F(LensCommand, FieldAndGravityAreTakenAndRefusedByRange) {
  Lens lens{{640, 640}, {180, 180}, {330, 310}, {0, 0, 0, 0}, 1.3};
  test::BoardSetup setup;
  setup.field_rad = lens.max_theta_rad;
  setup.views = 10;
  setup.columns = setup.rows = 7;
  ASSERT_TRUE(write_file_atomically(path("corners.json"),
                                    calibration::to_json(test::board_views(lens, setup).target_views)));
  const ProcessResult run =
      calibrate({"--corners", path("corners.json"), "--max-theta", "85", "--gravity", "0.5,-1.5,9.6"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("85.0 degrees off axis, extrapolated beyond 7"));
  const json file = json::parse(read_text_file(path("lens.json")).value());
  EXPECT_NEAR(file["max_theta_deg"], 85, 1e-9);
  EXPECT_LT(file["supported_theta_deg"], 75);
  const auto read = read_lens(path("lens.json"));
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_LT((read->zenith - Vec3d(0.5, -1.5, 9.6).normalized()).norm(), 1e-12);
  expect_refused({"--corners", path("corners.json"), "--max-theta", "0"}, 2, "--max-theta");
  expect_refused({"--corners", path("corners.json"), "--max-theta", "181"}, 2, "--max-theta");
  expect_refused({"--corners", path("corners.json"), "--gravity", "0,0,0"}, 2, "--gravity");
  expect_refused({"--corners", path("corners.json"), "--gravity", "1,2"}, 2, "--gravity");
  expect_refused({"--corners", path("corners.json"), "--gravity", "1,2,x"}, 2, "--gravity");
}

TEST_F(LensCommand, AFolderThatIsMissingIsAFailure) {
  Lens lens{{640, 640}, {180, 180}, {330, 310}, {0, 0, 0, 0}, kPi / 2};
  ASSERT_TRUE(write_file_atomically(path("corners.json"),
                                    calibration::to_json(test::board_views(lens, {}).target_views)));
  const ProcessResult run = test::run_process(
      LIGHTWELL_BIN_DIR "/lightwell",
      {"calibrate", "lens", "--corners", path("corners.json"), "--out", path("absent/lens.json")});
  EXPECT_EQ(run.exit_code, 1) << run.err;
}

}  // namespace
}  // namespace lightwell
