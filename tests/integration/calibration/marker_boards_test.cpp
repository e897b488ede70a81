// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// `lightwell calibrate lens` from pictures of marker boards through a fisheye whose lens is known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "interface/atomic_file.h"
#include "interface/calibration_io.h"
#include "interface/jpeg.h"
#include "tests/support/child_process.h"
#include "tests/support/photographed_board.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

using nlohmann::json;
using test::Print;
using test::View;

// Field of 200 degrees, off the image's middle.
const Lens kWide{{720, 720}, {205, 206}, {355, 362}, {-0.02, 0.002, 0, 0}, 100 * kPi / 180};

// Directions in which boards stand, degrees off axis and around it; the outermost are cut by the lens's circle.
struct Sight {
  double theta_deg, phi_deg;
};
constexpr Sight kSights[] = {{0, 0},    {20, 200}, {45, 10},  {45, 130}, {45, 250}, {72, 60},  {72, 130},
                             {72, 200}, {72, 270}, {72, 340}, {88, 0},   {88, 95},  {88, 180}, {88, 300}};

// Noise of 2 of 190 codes is some 0.02 px on a corner; a window on a bent edge adds up to 0.1 px on either axis.
constexpr double kMostRms = 0.15;  // px

class MarkerBoards : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  // One picture a sight, in which the board is tilted to all sides.
  std::vector<std::string> photographs(const Print& print, const Vec2d& middle_mm, double distance_mm) const {
    std::vector<std::string> files;
    for (std::size_t i = 0; i < std::size(kSights); ++i) {
      const double theta = kSights[i].theta_deg * kPi / 180, phi = kSights[i].phi_deg * kPi / 180;
      const Vec3d sight(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
      const double n = static_cast<double>(i);
      const Vec3d tilt(0.5 * std::cos(2.4 * n), 0.5 * std::sin(2.4 * n), 0.7 * n);
      const View view(kWide, middle_mm, sight, distance_mm * (1 + 0.1 * std::cos(n)), tilt);
      const auto with_hand = [&](double x, double y) {
        return (Vec2d(x, y) - 0.6 * middle_mm).norm() < 0.25 * middle_mm.norm() ? 0.45 : print(x, y);
      };
      const auto picture = view.photograph(i % 5 == 2 ? Print(with_hand) : print, static_cast<unsigned>(i));
      std::vector<std::uint8_t> rgb;
      for (const std::uint8_t code : picture.pixels) rgb.insert(rgb.end(), 3, code);
      files.push_back(path("view" + std::to_string(i) + ".jpg"));
      EXPECT_TRUE(
          write_file_atomically(files.back(), encode_jpeg(picture.width, picture.height, rgb, 95).value()));
    }
    return files;
  }

  // The report of the lens found in them.
  json calibrated(const std::vector<std::string>& files, const std::string& board) const {
    std::vector<std::string> words = {"calibrate", "lens",  "--board",        board,
                                      "--json",    "--out", path("lens.json")};
    words.insert(words.end(), files.begin(), files.end());
    const test::ProcessResult run = test::run_process(LIGHTWELL_BIN_DIR "/lightwell", words);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return json::parse(run.out, nullptr, false);
  }

 private:
  test::TemporaryFolder folder_;
};

// Every parameter within three standard deviations of the lens that took the pictures.
void expect_lens(const json& report, const Lens& truth) {
  const auto check = [&](const std::string& name, double found, double wanted, std::size_t index) {
    const double sigma = std::sqrt(report["covariance"][index][index].get<double>());
    EXPECT_LE(std::abs(found - wanted), 3 * sigma)
        << name << " " << found << " instead of " << wanted << ", sigma " << sigma;
  };
  for (std::size_t i = 0; i < 2; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    check("focal", report["focal"][i], truth.focal[axis], i);
    check("center", report["center"][i], truth.center[axis], 2 + i);
  }
  for (std::size_t i = 0; i < 4; ++i) check("k", report["k"][i], truth.k[i], 4 + i);
}

// Views in which a lens cuts the board, or a hand covers some of it, count like the others.
void expect_views(const json& report, std::size_t whole, int used, int partly) {
  int seen = 0, seen_partly = 0;
  std::string unused;
  for (const json& view : report["views"]) {
    const auto points = view["points"].get<std::size_t>() - view["rejected"].size();
    seen += view["used"] ? 1 : 0;
    seen_partly += view["used"] && points < 9 * whole / 10 ? 1 : 0;
    unused += view["name"].get<std::string>() + ": " + std::to_string(points) + " points, " +
              view["reason"].get<std::string>() + "\n";
  }
  EXPECT_GE(seen, used) << unused;
  EXPECT_GE(seen_partly, partly) << unused;
}

TEST_F(MarkerBoards, AnAprilGridGivesTheFisheyesLens) {
  const auto board = calibration::board_from_text("6x6:88:aprilgrid").value();
  const json report = calibrated(photographs(test::april_grid(board), {254, -180}, 420), "6x6:88:aprilgrid");
  ASSERT_TRUE(report.is_object());
  expect_lens(report, kWide);
  expect_views(report, 144, 13, 4);
  EXPECT_LT(report["rms_px"], kMostRms);
}

TEST_F(MarkerBoards, AChArUcoBoardGivesTheFisheyesLens) {
  const auto board = calibration::board_from_text("9x7:60:charuco").value();
  const json report = calibrated(photographs(test::charuco(board), {270, 210}, 360), "9x7:60:charuco");
  ASSERT_TRUE(report.is_object());
  expect_lens(report, kWide);
  expect_views(report, 48, 13, 4);
  EXPECT_LT(report["rms_px"], kMostRms);
}

}  // namespace
}  // namespace lightwell
