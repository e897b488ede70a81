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

struct AprilTags {
  std::vector<AprilTag> tags;      // with ids below what was asked for, each once
  std::vector<int> twice;          // such ids that are seen in two places, left out
  std::vector<int> beyond;         // ids from there on
  bool at_twice_its_size = false;  // whether the picture was looked at so: tags whose bits are below 2 px
};

// Tags with ids below `count`; those with black borders of two bits, as Kalibr prints them, or those with one, whichever
// are more. Of a picture of more than 32 megapixels, a smaller one is looked at. Olson 2011; Wang and Olson 2016, whose
// segmentation joins white pixels diagonally and black ones along edges only, so that a square at a tag's corner stays
// apart.
AprilTags find_april_tags(const cv::Mat& grey, int count);

}  // namespace lightwell::calibration
