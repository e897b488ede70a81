// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <utility>
#include <vector>

#include "calibration/detection/board.h"
#include "lighting/lens.h"

namespace lightwell::test {

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

// A grid as Kalibr prints it: the first tag at the lower left, its upper left corner the origin, rows upward; a black
// square at every crossing of the gaps.
inline Print april_grid(const calibration::Board& board, int border_bits = 2) {
  auto tags = std::make_shared<std::vector<Marker>>();
  for (int id = 0; id < board.columns * board.rows; ++id)
    tags->emplace_back(cv::aruco::DICT_APRILTAG_36h11, id, border_bits);
  return [board, tags](double x, double y) {
    const int c = static_cast<int>(std::floor(x / board.pitch_mm)),
              r = static_cast<int>(std::floor(y / board.pitch_mm));
    const double u = (x - c * board.pitch_mm) / board.marker_mm,
                 v = (y - r * board.pitch_mm) / board.marker_mm;
    // The crossing before the first column and row is that of cell (-1, -rows).
    if (c < -1 || c >= board.columns || r < -board.rows || r > 0)
      return x < -board.pitch_mm || x > (board.columns + 0.7) * board.pitch_mm ||
                     y < -board.rows * board.pitch_mm || y > 1.7 * board.pitch_mm
                 ? -1.0
                 : 1.0;
    if (u >= 1 && v >= 1) return 0.0;
    if (u >= 1 || v >= 1 || c < 0 || r <= -board.rows) return 1.0;
    return (*tags)[static_cast<std::size_t>(-r * board.columns + c)].at(u, v);
  };
}

// A ChArUco board as OpenCV prints it today: the first square is black; before 4.6 it was white where the rows are even.
// first_id: of its first marker
inline Print charuco(const calibration::Board& board, bool legacy = false,
                     int dictionary = cv::aruco::DICT_5X5_250, int first_id = 0) {
  const int white = legacy && board.rows % 2 == 0 ? 0 : 1;
  auto markers = std::make_shared<std::map<std::pair<int, int>, Marker>>();
  int id = first_id;
  for (int r = 0; r < board.rows; ++r)
    for (int c = 0; c < board.columns; ++c)
      if ((r + c) % 2 == white) markers->emplace(std::pair(r, c), Marker(dictionary, id++, 1));
  return [board, markers](double x, double y) {
    const double margin = (board.pitch_mm - board.marker_mm) / 2;
    const int c = static_cast<int>(std::floor(x / board.pitch_mm)),
              r = static_cast<int>(std::floor(y / board.pitch_mm));
    if (c < -1 || r < -1 || c > board.columns || r > board.rows) return -1.0;
    if (c < 0 || r < 0 || c == board.columns || r == board.rows) return 1.0;  // the sheet's border
    const auto marker = markers->find({r, c});
    if (marker == markers->end()) return 0.0;
    const double u = (x - c * board.pitch_mm - margin) / board.marker_mm,
                 v = (y - r * board.pitch_mm - margin) / board.marker_mm;
    return u < 0 || v < 0 || u >= 1 || v >= 1 ? 1.0 : marker->second.at(u, v);
  };
}

// Where a board stands before a lens: its middle in a direction, then tilted and turned about it.
struct View {
  Lens lens;
  Eigen::Matrix3d rotation;
  Vec3d origin;  // of the board's coordinates

  View(Lens before, const Vec2d& middle_mm, const Vec3d& sight, double distance_mm, const Vec3d& tilt_rad)
      : lens(std::move(before)) {
    rotation = Eigen::Quaterniond::FromTwoVectors(Vec3d::UnitZ(), sight).toRotationMatrix() *
               Eigen::AngleAxisd(tilt_rad.head<2>().norm(), Vec3d(tilt_rad.x(), tilt_rad.y(), 0).normalized())
                   .toRotationMatrix() *
               Eigen::AngleAxisd(tilt_rad.z(), Vec3d::UnitZ()).toRotationMatrix();
    origin = distance_mm * sight.normalized() - rotation * Vec3d(middle_mm.x(), middle_mm.y(), 0);
  }
  [[nodiscard]] Vec2d pixel(const Vec3d& board_mm) const {
    return lens.project(rotation * board_mm + origin);
  }

  // Mean of 3 x 3 samples a pixel, then 0.7 px of blur and noise of 2 codes; dark beyond the lens's field.
  [[nodiscard]] calibration::GreyPicture photograph(const Print& print, unsigned seed = 5) const {
    const int width = lens.image_size[0], height = lens.image_size[1];
    const Vec3d normal = rotation.col(2);
    constexpr double kNowhere = 1e9;  // mm
    // Places on the board of the pixels' corners; within a pixel they go straight to a thousandth of it.
    std::vector<Vec2d> places;
    for (int y = 0; y <= height; ++y)
      for (int x = 0; x <= width; ++x) {
        const Vec3d ray = lens.unproject(Vec2d(x - 0.5, y - 0.5));
        const double distance = normal.dot(origin) / normal.dot(ray);
        const Vec3d place = rotation.transpose() * (distance * ray - origin);
        places.push_back(distance > 0 && place.norm() < kNowhere ? Vec2d(place.head<2>())
                                                                 : Vec2d(kNowhere, kNowhere));
      }
    cv::Mat light = cv::Mat::zeros(height, width, CV_32F);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        if (lens.theta_rad({x, y}) > lens.max_theta_rad) continue;
        const Vec2d* upper = &places[static_cast<std::size_t>(y * (width + 1) + x)];
        const Vec2d* lower = upper + width + 1;
        float sum = 0;
        for (int s = 0; s < 9; ++s) {
          const double a = (s % 3 + 0.5) / 3, b = (s / 3 + 0.5) / 3;
          const Vec2d place =
              (1 - b) * ((1 - a) * upper[0] + a * upper[1]) + b * ((1 - a) * lower[0] + a * lower[1]);
          const double value = place.norm() < 5000 ? print(place.x(), place.y()) : -1;
          sum += static_cast<float>(value < 0 ? 0.45 : value) / 9;
        }
        light.at<float>(y, x) = sum;
      }
    cv::GaussianBlur(light, light, {}, 0.7);
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, 2);
    calibration::GreyPicture out{width, height, {}};
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        out.pixels.push_back(
            cv::saturate_cast<std::uint8_t>(25 + 190 * light.at<float>(y, x) + noise(random)));
    return out;
  }
};

}  // namespace lightwell::test
