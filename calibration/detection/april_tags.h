// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

namespace lightwell::calibration {

// A tag of the family 36h11 in a picture.
struct AprilTag {
  int id = 0;
  std::array<cv::Point2f, 4> corners;  // of its black border, clockwise, within some pixels of a bent side
};

// Mean length of a tag's sides, px.
double side_px(const AprilTag& tag);
cv::Point2f centre(const AprilTag& tag);

// Tags with ids below `count`, each once; those with black borders of two bits, as Kalibr prints them, or those with
// one, whichever are more. An id seen in two places is left out. Olson 2011; Wang and Olson 2016, whose segmentation
// joins white pixels diagonally and black ones along edges only, so that a square at a tag's corner stays apart.
std::vector<AprilTag> find_april_tags(const cv::Mat& grey, int count);

}  // namespace lightwell::calibration
