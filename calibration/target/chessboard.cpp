// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/target/chessboard.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace lightwell::calibration {
namespace {

cv::Mat scaled(const cv::Mat& grey, double scale) {
  if (scale == 1) return grey;
  cv::Mat out;
  cv::resize(grey, out, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  return out;
}

float at(const cv::Mat& grey, cv::Point2f p) {
  const int x = std::clamp(cvRound(p.x), 0, grey.cols - 1), y = std::clamp(cvRound(p.y), 0, grey.rows - 1);
  return grey.at<std::uint8_t>(y, x);
}

// How much the four quadrants between two axes look like checks: 2 × contrast for a corner of four, 0 for an edge,
// for the corner of one dark square on white, and for nothing.
float checks(const cv::Mat& grey, cv::Point2f p, cv::Point2f a, cv::Point2f b) {
  const float q0 = at(grey, p + a + b), q1 = at(grey, p - a + b), q2 = at(grey, p - a - b),
              q3 = at(grey, p + a - b);
  return std::abs(q0 + q2 - q1 - q3) - std::abs(q0 - q2) - std::abs(q1 - q3);
}

bool inside(const cv::Mat& grey, cv::Point2f p) {
  return p.x >= 0 && p.y >= 0 && p.x <= static_cast<float>(grey.cols - 1) &&
         p.y <= static_cast<float>(grey.rows - 1);
}

// A row of corners at the border, and the row inside of it.
struct Border {
  std::vector<cv::Point2f> outer, inner;
};

bool has_row_beyond(const cv::Mat& grey, const Border& border) {
  std::size_t seen = 0, found = 0;
  for (std::size_t i = 0; i < border.outer.size(); ++i) {
    const cv::Point2f out = border.outer[i] - border.inner[i];
    const cv::Point2f along = i + 1 < border.outer.size() ? border.outer[i + 1] - border.outer[i]
                                                          : border.outer[i] - border.outer[i - 1];
    const float here = checks(grey, border.outer[i], 0.3f * out, 0.3f * along);
    float best = 0;
    // The next row is about a step away: fisheyes shrink it, near boards stretch it.
    for (const float step : {0.7f, 0.8f, 0.9f, 1.0f, 1.1f})
      for (const float side : {-0.1f, 0.f, 0.1f})
        best = std::max(
            best, checks(grey, border.outer[i] + step * out + side * along, 0.25f * out, 0.25f * along));
    if (!inside(grey, border.outer[i] + 1.3f * out)) continue;
    ++seen;
    found += best > 0.5f * here;
  }
  return seen >= 2 && 5 * found >= 4 * seen;
}

}  // namespace

std::vector<cv::Point2f> find_chessboard(const cv::Mat& grey, int columns, int rows) {
  const double base = std::min(1.0, 1400.0 / std::max(grey.cols, grey.rows));
  std::vector<cv::Point2f> corners;
  const cv::Size size(columns, rows);
  const auto in_picture = [&](double scale) {
    // The centre of pixel (0, 0) is the origin at every scale.
    for (auto& p : corners)
      p = (p + cv::Point2f(0.5f, 0.5f)) / static_cast<float>(scale) - cv::Point2f(0.5f, 0.5f);
    return corners;
  };
  for (const double factor : {1.0, 0.5, 1.5, 0.75, 2.0})
    if (cv::findChessboardCorners(scaled(grey, base * factor), size, corners,
                                  cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE))
      return in_picture(base * factor);
  for (const double factor : {0.5, 0.75})
    if (cv::findChessboardCornersSB(
            scaled(grey, base * factor), size, corners,
            cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_ACCURACY))
      return in_picture(base * factor);
  return {};
}

void refine_corners(const cv::Mat& grey, const std::vector<double>& neighbour_px,
                    std::vector<cv::Point2f>& corners) {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const int half = std::clamp(static_cast<int>(0.35 * neighbour_px[i]), 2, 11);
    std::vector<cv::Point2f> one = {corners[i]};
    cv::cornerSubPix(grey, one, {half, half}, {-1, -1},
                     {cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 60, 1e-3});
    corners[i] = one[0];
  }
}

bool goes_on(const cv::Mat& grey, const std::vector<cv::Point2f>& corners, int columns, int rows) {
  const auto corner = [&](int r, int c) { return corners[static_cast<std::size_t>(r * columns + c)]; };
  Border borders[4];
  for (int c = 0; c < columns; ++c) {
    borders[0].outer.push_back(corner(0, c));
    borders[0].inner.push_back(corner(1, c));
    borders[1].outer.push_back(corner(rows - 1, c));
    borders[1].inner.push_back(corner(rows - 2, c));
  }
  for (int r = 0; r < rows; ++r) {
    borders[2].outer.push_back(corner(r, 0));
    borders[2].inner.push_back(corner(r, 1));
    borders[3].outer.push_back(corner(r, columns - 1));
    borders[3].inner.push_back(corner(r, columns - 2));
  }
  return std::any_of(std::begin(borders), std::end(borders),
                     [&](const Border& b) { return has_row_beyond(grey, b); });
}

std::size_t count_saddles(const cv::Mat& grey) {
  // At a width of about 700 px a check is some 10 px wide.
  cv::Mat small;
  cv::GaussianBlur(scaled(grey, std::min(1.0, 700.0 / std::max(grey.cols, grey.rows))), small, {}, 1);
  double darkest = 0, brightest = 0;
  cv::minMaxLoc(small, &darkest, &brightest);
  const auto least = static_cast<float>(0.25 * (brightest - darkest));
  if (least < 4) return 0;
  constexpr int kRadius = 4, kApart = 4;
  cv::Mat response(small.size(), CV_32F, cv::Scalar(0));
  for (int y = kRadius; y < small.rows - kRadius; ++y)
    for (int x = kRadius; x < small.cols - kRadius; ++x) {
      const cv::Point2f p(static_cast<float>(x), static_cast<float>(y));
      response.at<float>(y, x) =
          std::max(checks(small, p, {3, 0}, {0, 3}), checks(small, p, {3, 3}, {3, -3}));
    }
  cv::Mat largest;
  cv::dilate(response, largest, cv::Mat::ones(2 * kApart + 1, 2 * kApart + 1, CV_8U));
  return static_cast<std::size_t>(cv::countNonZero((response == largest) & (response > least)));
}

}  // namespace lightwell::calibration
