// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "calibration/detection/board.h"

namespace lightwell::calibration {

struct MarkerCorner {
  Vec3d target_mm;
  cv::Point2f pixel;
};

// Corners of the checks between ArUco markers; whichever of ArUco's usual dictionaries the picture shows, and, with even
// rows, whichever of the two layouts that OpenCV has printed.
std::vector<MarkerCorner> find_charuco(const cv::Mat& grey, const Board& board);

}  // namespace lightwell::calibration
