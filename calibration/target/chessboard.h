// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "calibration/target/board.h"

namespace lightwell::calibration {

// Inner corners, row by row; empty where they are not all found.
std::vector<cv::Point2f> find_chessboard(const cv::Mat& grey, int columns, int rows);

// Corners moved to where the picture's edges meet, each in a window that fits between its neighbours.
// neighbours: for each corner the distance to its nearest one, px
void refine_corners(const cv::Mat& grey, const std::vector<double>& neighbour_px,
                    std::vector<cv::Point2f>& corners);

// Whether the checks go on beyond the outermost corners, so that the board has more of them.
bool goes_on(const cv::Mat& grey, const std::vector<cv::Point2f>& corners, int columns, int rows);

// Places that look like a corner of four checks, anywhere in the picture.
std::size_t count_saddles(const cv::Mat& grey);

}  // namespace lightwell::calibration
