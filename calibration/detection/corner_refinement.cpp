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
  return static_cast<int>(std::clamp(0.35 * neighbour_px, 2.0, 11.0));
}

// In a window that reaches 1.5 px far, of a picture twice as large.
cv::Point2f refined_closely(const cv::Mat& grey, cv::Point2f corner) {
  constexpr int kAround = 12;  // px
  const cv::Point middle(cvRound(corner.x), cvRound(corner.y));
  const cv::Rect near = cv::Rect(middle.x - kAround, middle.y - kAround, 2 * kAround + 1, 2 * kAround + 1) &
                        cv::Rect(0, 0, grey.cols, grey.rows);
  if (near.empty()) return corner;
  cv::Mat larger;
  cv::resize(grey(near), larger, {}, 2, 2, cv::INTER_CUBIC);
  // The centre of pixel (0, 0) is the origin in both.
  const cv::Point2f half(0.5f, 0.5f), origin = near.tl();
  return (refined(larger, 2 * (corner - origin + half) - half, 3) + half) / 2 - half + origin;
}

}  // namespace

void refine_corners(const cv::Mat& grey, const std::vector<double>& neighbour_px,
                    std::vector<cv::Point2f>& corners) {
  for (std::size_t i = 0; i < corners.size(); ++i)
    corners[i] = refined(grey, corners[i], half_window(neighbour_px[i]));
}

std::optional<cv::Point2f> meeting_point(const cv::Mat& grey, cv::Point2f near, double room_px) {
  const int half = half_window(room_px), wide = std::max(half + 1, 8 * half / 5);
  if (half > room_px) return {};
  const cv::Point2f place = refined(grey, near, half);
  const bool has_room = wide + 0.5 <= room_px;
  // Where no edges cross, a search stays at its start, or goes to somewhere on the one edge near it. Of two ways aside
  // one is along it.
  for (const cv::Point2f& aside : {cv::Point2f(0.4f, 0.3f), cv::Point2f(-0.3f, 0.4f)}) {
    constexpr double kMostApart = 0.25;  // px
    const cv::Point2f other =
        has_room ? refined(grey, place + aside, wide) : refined_closely(grey, place + aside);
    if (cv::norm(other - place) > kMostApart) return {};
  }
  return place;
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
