// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/detection/markers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "calibration/detection/board.h"
#include "lighting/lens.h"
#include "tests/support/photographed_board.h"

namespace lightwell::calibration {
namespace {

using test::Marker;
using test::Print;
using test::View;

// As OpenCV prints it today: the first square is black; before 4.6 it was white where the rows are even.
Print charuco(const Board& board, bool legacy) {
  const int white = legacy && board.rows % 2 == 0 ? 0 : 1;
  std::map<std::pair<int, int>, Marker> markers;
  int id = 0;
  for (int r = 0; r < board.rows; ++r)
    for (int c = 0; c < board.columns; ++c)
      if ((r + c) % 2 == white) markers.emplace(std::pair(r, c), Marker(cv::aruco::DICT_5X5_250, id++, 1));
  return [=](double x, double y) {
    const double margin = (board.pitch_mm - board.marker_mm) / 2;
    const int c = static_cast<int>(std::floor(x / board.pitch_mm)),
              r = static_cast<int>(std::floor(y / board.pitch_mm));
    if (c < -1 || r < -1 || c > board.columns || r > board.rows) return -1.0;
    if (c < 0 || r < 0 || c == board.columns || r == board.rows) return 1.0;  // the sheet's border
    const auto marker = markers.find({r, c});
    if (marker == markers.end()) return 0.0;
    const double u = (x - c * board.pitch_mm - margin) / board.marker_mm,
                 v = (y - r * board.pitch_mm - margin) / board.marker_mm;
    return u < 0 || v < 0 || u >= 1 || v >= 1 ? 1.0 : marker->second.at(u, v);
  };
}

// Field of 200 degrees.
const Lens kWide{{720, 720}, {205, 205}, {355, 362}, {-0.02, 0.002, 0, 0}, 100 * kPi / 180};

// A board 45 degrees off the axis of a fisheye, tilted and turned.
View slanted(double middle_x, double middle_y, double distance_mm) {
  const Vec3d sight(std::sin(0.8) * std::cos(0.5), std::sin(0.8) * std::sin(0.5), std::cos(0.8));
  return {kWide, {middle_x, middle_y}, sight, distance_mm, {0.21, 0.28, 0.4}};
}

// Every point is where its place on the board is seen. Noise of 2 of 190 codes is some 0.02 px on a corner; a window
// of a few pixels on a bent edge adds up to 0.1 px, and 0.3 px is what calibrations are asked for.
void expect_in_place(const Detection& found, const View& view, const Vec3d& first) {
  for (const Correspondence& point : found.points)
    EXPECT_LT((point.pixel - view.pixel(point.target_mm + first)).norm(), 0.3) << point.target_mm.transpose();
}

Board board_of(const std::string& text) {
  return board_from_text(text).value();
}

TEST(Charuco, CornersThroughAFisheyeAreInTheirPlaces) {
  const Board board = board_of("5x7:40:charuco");
  const View view = slanted(100, 140, 250);
  const Detection found = detect_board(view.photograph(charuco(board, false)), board);
  EXPECT_EQ(found.points.size(), 24u) << found.reason;
  expect_in_place(found, view, {40, 40, 0});
}

TEST(Charuco, BothLayoutsOfEvenRowsAreToldApart) {
  const Board board = board_of("7x6:40:charuco");
  const View view = slanted(140, 120, 240);
  for (const bool legacy : {false, true}) {
    const Detection found = detect_board(view.photograph(charuco(board, legacy)), board);
    // Of 30; two markers may be lost where the lens makes their bits 2 px small.
    EXPECT_GE(found.points.size(), 26u) << legacy << found.reason;
    expect_in_place(found, view, {40, 40, 0});
  }
}

TEST(Charuco, AHiddenPartIsLeftOut) {
  const Board board = board_of("5x7:40:charuco");
  const View view = slanted(100, 140, 250);
  const Print whole = charuco(board, false);
  const auto hidden = [&](double x, double y) { return x + y > 260 ? 0.5 : whole(x, y); };
  const Detection found = detect_board(view.photograph(hidden), board);
  // Six corners have two whole markers; four more have one of which the cover takes a 7 mm corner.
  EXPECT_GE(found.points.size(), 6u);
  EXPECT_LE(found.points.size(), 10u);
  expect_in_place(found, view, {40, 40, 0});
}

const Lens kNarrow{{720, 720}, {340, 340}, {355, 362}, {0.02, 0.002, 0, 0}, 60 * kPi / 180};

View of_grid(const Lens& lens, double distance_mm) {
  const Vec3d sight(std::sin(0.8) * std::cos(0.5), std::sin(0.8) * std::sin(0.5), std::cos(0.8));
  return {lens, {254, -180}, sight, distance_mm, {0.21, 0.28, 0.4}};
}

// Shortest side of a tag that is wholly in view, px; 0 of one that is not.
double side_in_view(const View& view, const Board& board, int column, int row) {
  Vec2d corners[4];
  for (int k = 0; k < 4; ++k) {
    const Vec3d place(board.pitch_mm * column + (k == 1 || k == 2 ? board.marker_mm : 0),
                      -board.pitch_mm * row + (k >= 2 ? board.marker_mm : 0), 0);
    corners[k] = view.pixel(place);
    const Vec3d eye = view.rotation * place + view.origin;
    const bool in_field = std::atan2(eye.head<2>().norm(), eye.z()) < view.lens.max_theta_rad;
    if (!in_field || corners[k].minCoeff() < 4 || corners[k].maxCoeff() > 715) return 0;
  }
  double side = (corners[3] - corners[0]).norm();
  for (int k = 0; k < 3; ++k) side = std::min(side, (corners[k + 1] - corners[k]).norm());
  return side;
}

// Part of the tags in view with sides above `least_px` of which corners were found.
double part_read(const Detection& found, const View& view, const Board& board, double least_px) {
  std::set<std::pair<int, int>> read;
  for (const Correspondence& point : found.points)
    read.emplace(static_cast<int>(std::floor(point.target_mm.x() / board.pitch_mm)),
                 -static_cast<int>(std::floor(point.target_mm.y() / board.pitch_mm)));
  int seen = 0, all = 0;
  for (int r = 0; r < board.rows; ++r)
    for (int c = 0; c < board.columns; ++c) {
      if (side_in_view(view, board, c, r) <= least_px) continue;
      ++all;
      seen += read.count({c, r}) > 0;
    }
  return static_cast<double>(seen) / all;
}

TEST(AprilGrid, KalibrsTagsThroughFisheyesAreReadAndTheirCornersInPlace) {
  const Board board = board_of("6x6:88:aprilgrid");
  struct Case {
    const Lens& lens;
    double distance_mm, least_px, part;
  };
  // Nearest, the outer tags of the wide lens are bent and seen at a slant: 19 of 32 are read. Farthest, tags are 14 to
  // 20 px large: 22 of 36.
  for (const Case& c : {Case{kNarrow, 250, 25, 0.9}, Case{kWide, 450, 25, 0.9}, Case{kWide, 250, 25, 0.55},
                        Case{kWide, 700, 14, 0.55}}) {
    const View view = of_grid(c.lens, c.distance_mm);
    const Detection found = detect_board(view.photograph(test::april_grid(board)), board);
    EXPECT_GE(part_read(found, view, board, c.least_px), c.part) << c.lens.focal.x() << " " << c.distance_mm;
    expect_in_place(found, view, {0, 0, 0});
  }
}

TEST(AprilGrid, AHiddenPartIsLeftOut) {
  const Board board = board_of("6x6:88:aprilgrid");
  const View view = of_grid(kWide, 450);
  const Print whole = test::april_grid(board);
  const Detection found = detect_board(
      view.photograph([&](double x, double y) { return x - y > 500 ? 0.5 : whole(x, y); }), board);
  EXPECT_GE(found.points.size(), 40u);
  for (const Correspondence& point : found.points) EXPECT_LT(point.target_mm.x() - point.target_mm.y(), 500);
  expect_in_place(found, view, {0, 0, 0});
}

}  // namespace
}  // namespace lightwell::calibration
