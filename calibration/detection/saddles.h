// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

namespace lightwell::calibration {

// A place where two light and two dark quadrants meet, as at a corner of four checks.
struct Saddle {
  cv::Point2f pixel;                // within about a pixel
  std::array<cv::Point2f, 4> edge;  // unit directions of the four edges, in the order in which angles grow
  bool light_after_first = false;   // light in the quadrant after edge[0]; the others alternate
  float contrast = 0;               // light less dark, codes
  // Whether it is light on the side of edge k toward which angles grow.
  [[nodiscard]] bool light_after(std::size_t k) const { return light_after_first == (k % 2 == 0); }
};

// The strongest saddles of a picture, 4000 at most, whose quadrants are at least some 5 px wide.
std::vector<Saddle> find_saddles(const cv::Mat& grey);

}  // namespace lightwell::calibration
