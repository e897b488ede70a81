// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/detection/markers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/aruco.hpp>
#include <random>
#include <set>
#include <string>

#include "calibration/detection/board.h"
#include "lighting/lens.h"
#include "tests/support/photographed_board.h"

namespace lightwell::calibration {
namespace {

using test::charuco;
using test::Print;
using test::View;

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
  // 14 of the 24 corners are in sight; the outermost four are 14 mm from the cover.
  EXPECT_GE(found.points.size(), 10u);
  for (const Correspondence& point : found.points) EXPECT_LT(point.target_mm.head<2>().sum() + 80, 260);
  expect_in_place(found, view, {40, 40, 0});
}

// One corner has no neighbour that says how large its window may be.
TEST(Charuco, ACornerBetweenTheOnlyTwoMarkersIsInItsPlace) {
  const Board board = board_of("5x7:40:charuco");
  const Print whole = charuco(board, false);
  for (const double distance_mm : {120, 180, 250}) {
    const View view = slanted(80, 80, distance_mm);
    const auto two = [&](double x, double y) {
      return x > 40 && x < 120 && y > 40 && y < 120 ? whole(x, y) : 0.6;
    };
    const Detection found = detect_board(view.photograph(two), board);
    ASSERT_EQ(found.points.size(), 1u) << distance_mm << found.reason;
    EXPECT_EQ(found.points[0].target_mm, Vec3d(40, 40, 0));
    expect_in_place(found, view, {40, 40, 0});
  }
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
  // Nearest, the outer tags of the wide lens are bent and seen at a slant: the library alone reads 19 of 32. Farthest,
  // tags are 14 to 20 px large: 22 of 36.
  for (const Case& c : {Case{kNarrow, 250, 25, 0.95}, Case{kWide, 450, 25, 0.95}, Case{kWide, 250, 25, 0.95},
                        Case{kWide, 700, 14, 0.95}}) {
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

TEST(AprilGrid, BordersOfOneBitAreRead) {
  const Board board = board_of("6x6:88:aprilgrid");
  const View view = of_grid(kWide, 450);
  const Detection found = detect_board(view.photograph(test::april_grid(board, 1)), board);
  EXPECT_GE(part_read(found, view, board, 25), 0.9);
  expect_in_place(found, view, {0, 0, 0});
}

// Of a print, with the square around one place put over those around others.
Print copied(const Print& print, double pitch_mm, Vec2d from, const std::vector<Vec2d>& to) {
  return [=](double x, double y) {
    for (const Vec2d& place : to)
      if (const Vec2d off = Vec2d(x, y) - place; off.cwiseAbs().maxCoeff() < pitch_mm / 2)
        return print(from.x() + off.x(), from.y() + off.y());
    return print(x, y);
  };
}

TEST(AprilGrid, ATagThatIsSeenTwiceIsNotRead) {
  const Board board = board_of("6x6:88:aprilgrid");
  const View view = of_grid(kWide, 450);
  const double middle = board.marker_mm / 2;
  // Tag 14, of the third column and row, is printed in the place of tag 22, too.
  const Vec2d from(2 * 88 + middle, -2 * 88 + middle), to(4 * 88 + middle, -3 * 88 + middle);
  const Detection found =
      detect_board(view.photograph(copied(test::april_grid(board), 88, from, {to})), board);
  EXPECT_GE(found.points.size(), 100u);
  expect_in_place(found, view, {0, 0, 0});
}

TEST(Charuco, AMarkerThatIsSeenTwiceIsNotRead) {
  const Board board = board_of("5x7:40:charuco");
  const View view = slanted(100, 140, 250);
  const Detection found =
      detect_board(view.photograph(copied(charuco(board), 40, {60, 100}, {{60, 180}})), board);
  EXPECT_GE(found.points.size(), 16u) << found.reason;
  expect_in_place(found, view, {40, 40, 0});
}

TEST(MarkerBoards, MarkersOfAnotherBoardAreNamed) {
  struct Case {
    std::string asked;
    Print shown;
    std::string reason;
  };
  const Board grid = board_of("6x6:88:aprilgrid"), checks = board_of("7x6:88:charuco");
  const Print tags = test::april_grid(grid);
  const Print below = [p = charuco(checks)](double x, double y) {
    return p(x, y + 528);
  };  // where the grid is
  const Print others = [p = charuco(checks, false, cv::aruco::DICT_5X5_250, 40)](double x, double y) {
    return p(x, y + 528);
  };
  for (const Case& c :
       {Case{"5x6:88:aprilgrid", tags,
             "shows AprilTags 30, 31, 32, 33 and 2 more, a 5x6 aprilgrid has 0 to 29"},
        Case{"9x4:88:aprilgrid", tags, "not where a 9x4 aprilgrid has them: are its columns and rows right?"},
        Case{"6x6:88:aprilgrid", below,
             "shows ArUco markers of 5x5 bits, a 6x6 aprilgrid has AprilTags 36h11"},
        Case{"7x6:88:charuco", tags, "shows AprilTags 36h11, a 7x6 charuco has ArUco markers"},
        Case{"7x6:88:charuco", others, "a 7x6 charuco has 0 to 20"}}) {
    const Detection found = detect_board(of_grid(kWide, 450).photograph(c.shown), board_of(c.asked));
    EXPECT_TRUE(found.points.empty()) << c.asked;
    EXPECT_TRUE(found.of_no_board) << c.asked << ": " << found.reason;
    EXPECT_THAT(found.reason, testing::HasSubstr(c.reason));
  }
}

// One tag or marker may be of something behind the board.
TEST(MarkerBoards, AForeignMarkerIsNoOtherBoard) {
  const Board grid = board_of("6x6:88:aprilgrid"), large = board_of("8x8:88:aprilgrid");
  const Print tags = test::april_grid(large);
  const auto one = [&](double x, double y) {
    return x > 440 - 10 && x < 520 && y > -440 - 10 && y < -360 ? tags(x, y) : 0.5;  // tag 45
  };
  const Detection found = detect_board(of_grid(kWide, 450).photograph(one), grid);
  EXPECT_TRUE(found.points.empty());
  EXPECT_FALSE(found.of_no_board) << found.reason;
}

// Of a hundred frames with 4 x 4 random bits some six are in a dictionary of a thousand: windows of a house are no board.
TEST(MarkerBoards, FramesWithRandomBitsAreNoOtherBoard) {
  for (const unsigned seed : {1u, 2u}) {
    std::mt19937 random(seed);
    cv::Mat grey(720, 720, CV_8U, cv::Scalar(200));
    constexpr int kBit = 8, kPitch = 70;  // px
    for (int y = 20; y + 6 * kBit < grey.rows; y += kPitch)
      for (int x = 20; x + 6 * kBit < grey.cols; x += kPitch) {
        grey(cv::Rect(x, y, 6 * kBit, 6 * kBit)) = 20;
        for (int bit = 0; bit < 16; ++bit)
          if (random() % 2 == 0)
            grey(cv::Rect(x + (1 + bit % 4) * kBit, y + (1 + bit / 4) * kBit, kBit, kBit)) = 200;
      }
    const GreyPicture picture{grey.cols, grey.rows, {grey.datastart, grey.dataend}};
    std::vector<int> ids;
    std::vector<std::vector<cv::Point2f>> corners;
    cv::aruco::detectMarkers(grey, cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_1000), corners,
                             ids);
    EXPECT_GE(ids.size(), 3u);  // else the picture asks nothing
    for (const char* board : {"6x6:88:aprilgrid", "7x6:40:charuco"}) {
      const Detection found = detect_board(picture, board_of(board));
      EXPECT_TRUE(found.points.empty()) << board;
      EXPECT_FALSE(found.of_no_board) << board << ": " << found.reason;
    }
  }
}

// Half of this board's quads are black squares, which are no frames.
TEST(MarkerBoards, AChArUcoBoardOfFourByFourBitsIsAnotherBoard) {
  const Print shown = [p = charuco(board_of("7x6:88:charuco"), false, cv::aruco::DICT_4X4_250)](
                          double x, double y) { return p(x, y + 528); };
  const Detection found = detect_board(of_grid(kWide, 450).photograph(shown), board_of("6x6:88:aprilgrid"));
  EXPECT_TRUE(found.of_no_board) << found.reason;
  EXPECT_THAT(found.reason, testing::HasSubstr("shows ArUco markers of 4x4 bits"));
}

}  // namespace
}  // namespace lightwell::calibration
