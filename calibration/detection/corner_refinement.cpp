// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/detection/corner_refinement.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace lightwell::calibration {
namespace {

cv::Point2f refined(const cv::Mat& grey, cv::Point2f corner, int half) {
  std::vector<cv::Point2f> one = {corner};
  cv::cornerSubPix(grey, one, {half, half}, {-1, -1},
                   {cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 60, 1e-3});
  return one[0];
}

int half_window(double neighbour_px) {
  return std::clamp(static_cast<int>(0.35 * neighbour_px), 2, 11);
}

}  // namespace

void refine_corners(const cv::Mat& grey, const std::vector<double>& neighbour_px,
                    std::vector<cv::Point2f>& corners) {
  for (std::size_t i = 0; i < corners.size(); ++i)
    corners[i] = refined(grey, corners[i], half_window(neighbour_px[i]));
}

std::optional<cv::Point2f> meeting_point(const cv::Mat& grey, cv::Point2f near, double room_px) {
  const cv::Point2f narrow = refined(grey, near, half_window(room_px)),
                    wide = refined(grey, near, half_window(1.6 * room_px));
  constexpr double kMostApart = 0.25;  // px
  if (cv::norm(narrow - wide) > kMostApart) return {};
  return narrow;
}

float code_at(const cv::Mat& grey, cv::Point2f place) {
  const auto x = std::floor(place.x), y = std::floor(place.y);
  const float a = place.x - x, b = place.y - y;
  const auto at = [&](float u, float v) {
    return static_cast<float>(grey.at<std::uint8_t>(std::clamp(static_cast<int>(v), 0, grey.rows - 1),
                                                    std::clamp(static_cast<int>(u), 0, grey.cols - 1)));
  };
  return (1 - b) * ((1 - a) * at(x, y) + a * at(x + 1, y)) +
         b * ((1 - a) * at(x, y + 1) + a * at(x + 1, y + 1));
}

}  // namespace lightwell::calibration
