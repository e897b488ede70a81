// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/detection/corner_refinement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>

namespace lightwell::calibration {
namespace {

const cv::Point2f kMiddle(100.3f, 99.6f);
constexpr double kRooms[] = {4, 12, 40};  // px: of the least windows, of some between, and of the largest

// What a picture shows at a place from its middle, 0 to 1; mean of 10 x 10 samples a pixel, 0.7 px of blur.
cv::Mat photographed(const std::function<double(double x, double y)>& scene) {
  cv::Mat light(200, 200, CV_32F), out;
  for (int y = 0; y < light.rows; ++y)
    for (int x = 0; x < light.cols; ++x) {
      double sum = 0;
      for (int s = 0; s < 100; ++s)
        sum += scene(x + (s % 10 + 0.5) / 10 - 0.5 - static_cast<double>(kMiddle.x),
                     y + (s / 10 + 0.5) / 10 - 0.5 - static_cast<double>(kMiddle.y)) /
               100;
      light.at<float>(y, x) = static_cast<float>(30 + 190 * sum);
    }
  cv::GaussianBlur(light, light, {}, 0.7);
  light.convertTo(out, CV_8U);
  return out;
}

double checks(double x, double y) {
  return (0.9 * x + 0.3 * y > 0) == (-0.2 * x + 0.95 * y > 0) ? 0 : 1;
}

// Lines along the raster are off by up to half a sample, 0.05 px on either axis; eight bits leave 0.03 px.
TEST(MeetingPoint, IsWhereChecksMeet) {
  const cv::Mat grey = photographed(checks);
  for (const double room_px : {2.5, 4.0, 12.0, 40.0})
    for (const cv::Point2f& off : {cv::Point2f(0.5f, -0.4f), cv::Point2f(-0.6f, 0.3f)}) {
      const auto place = meeting_point(grey, kMiddle + off, room_px);
      ASSERT_TRUE(place) << room_px;
      EXPECT_LT(cv::norm(*place - kMiddle), 0.1) << room_px;
    }
}

// The windows find different places on it, each on another chord.
TEST(MeetingPoint, IsNotOnABentEdge) {
  for (const double room_px : kRooms) {
    const cv::Mat grey = photographed(
        [=](double x, double y) { return std::hypot(x - room_px / 2, y) < room_px / 2 ? 0 : 1; });
    EXPECT_FALSE(meeting_point(grey, kMiddle + cv::Point2f(0.5f, -0.4f), room_px)) << room_px;
  }
}

TEST(MeetingPoint, IsNotWhereAllIsAlike) {
  const cv::Mat grey = photographed([](double, double) { return 0.5; });
  for (const double room_px : kRooms) EXPECT_FALSE(meeting_point(grey, kMiddle, room_px)) << room_px;
}

// Something dark reaches into the wider window.
TEST(MeetingPoint, IsNotBesideSomethingElse) {
  for (const double room_px : {12.0, 40.0}) {
    const double from = 0.35 * room_px + 1;
    const cv::Mat grey =
        photographed([=](double x, double y) { return x > from && y < -from ? 0 : checks(x, y); });
    EXPECT_FALSE(meeting_point(grey, kMiddle + cv::Point2f(0.5f, -0.4f), room_px)) << room_px;
  }
}

TEST(MeetingPoint, NeedsRoom) {
  EXPECT_FALSE(meeting_point(photographed(checks), kMiddle, 1.9));
}

}  // namespace
}  // namespace lightwell::calibration
