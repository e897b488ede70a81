// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/target/markers.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "calibration/target/board.h"
#include "lighting/lens.h"

namespace lightwell::calibration {
namespace {

// Light at a place on the board, mm, y down; negative where the board is not.
using Print = std::function<double(double x, double y)>;

// A marker's bits as drawn, with its border: 0 or 1 at a place, in parts of its side.
class Marker {
 public:
  Marker(int dictionary, int id, int border_bits) {
    const auto markers = cv::aruco::getPredefinedDictionary(dictionary);
    cv::aruco::drawMarker(markers, id, markers->markerSize + 2 * border_bits, bits_, border_bits);
  }
  [[nodiscard]] double at(double u, double v) const {
    return bits_.at<std::uint8_t>(static_cast<int>(v * bits_.rows), static_cast<int>(u * bits_.cols)) ? 1 : 0;
  }

 private:
  cv::Mat bits_;
};

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

// A board before a fisheye of 200 degrees, its middle 45 degrees off axis, tilted and turned.
struct View {
  Lens lens{{720, 720}, {205, 205}, {355, 362}, {-0.02, 0.002, 0, 0}, 100 * kPi / 180};
  Eigen::Matrix3d rotation;
  Vec3d origin;  // of the board's coordinates

  View(double middle_x, double middle_y, double distance_mm) {
    const Vec3d sight(std::sin(0.8) * std::cos(0.5), std::sin(0.8) * std::sin(0.5), std::cos(0.8));
    rotation = Eigen::Quaterniond::FromTwoVectors(Vec3d::UnitZ(), sight).toRotationMatrix() *
               Eigen::AngleAxisd(0.35, Vec3d(0.6, 0.8, 0)).toRotationMatrix() *
               Eigen::AngleAxisd(0.4, Vec3d::UnitZ()).toRotationMatrix();
    origin = distance_mm * sight - rotation * Vec3d(middle_x, middle_y, 0);
  }
  [[nodiscard]] Vec2d pixel(const Vec3d& board_mm) const {
    return lens.project(rotation * board_mm + origin);
  }

  // Mean of 3 x 3 samples a pixel, then 0.7 px of blur and noise of 2 codes.
  [[nodiscard]] GreyPicture photograph(const Print& print) const {
    const Vec3d normal = rotation.col(2);
    cv::Mat light(720, 720, CV_32F);
    for (int y = 0; y < 720; ++y)
      for (int x = 0; x < 720; ++x) {
        float sum = 0;
        for (int s = 0; s < 9; ++s) {
          const Vec3d ray = lens.unproject(Vec2d(x + (s % 3 - 1) / 3.0, y + (s / 3 - 1) / 3.0));
          const double distance = normal.dot(origin) / normal.dot(ray);
          const Vec3d board = rotation.transpose() * (distance * ray - origin);
          const double value =
              distance > 0 && board.head<2>().norm() < 2000 ? print(board.x(), board.y()) : -1;
          sum += static_cast<float>(value < 0 ? 0.45 : value) / 9;
        }
        light.at<float>(y, x) = sum;
      }
    cv::GaussianBlur(light, light, {}, 0.7);
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0, 2);
    GreyPicture out{720, 720, {}};
    for (int y = 0; y < 720; ++y)
      for (int x = 0; x < 720; ++x)
        out.pixels.push_back(
            cv::saturate_cast<std::uint8_t>(25 + 190 * light.at<float>(y, x) + noise(random)));
    return out;
  }
};

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
  const View view(100, 140, 250);
  const Detection found = detect_board(view.photograph(charuco(board, false)), board);
  EXPECT_EQ(found.points.size(), 24u) << found.reason;
  expect_in_place(found, view, {40, 40, 0});
}

TEST(Charuco, BothLayoutsOfEvenRowsAreToldApart) {
  const Board board = board_of("7x6:40:charuco");
  const View view(140, 120, 240);
  for (const bool legacy : {false, true}) {
    const Detection found = detect_board(view.photograph(charuco(board, legacy)), board);
    // Of 30; two markers may be lost where the lens makes their bits 2 px small.
    EXPECT_GE(found.points.size(), 26u) << legacy << found.reason;
    expect_in_place(found, view, {40, 40, 0});
  }
}

TEST(Charuco, AHiddenPartIsLeftOut) {
  const Board board = board_of("5x7:40:charuco");
  const View view(100, 140, 250);
  const Print whole = charuco(board, false);
  const auto hidden = [&](double x, double y) { return x + y > 260 ? 0.5 : whole(x, y); };
  const Detection found = detect_board(view.photograph(hidden), board);
  // Six corners have two whole markers; four more have one of which the cover takes a 7 mm corner.
  EXPECT_GE(found.points.size(), 6u);
  EXPECT_LE(found.points.size(), 10u);
  expect_in_place(found, view, {40, 40, 0});
}

}  // namespace
}  // namespace lightwell::calibration
