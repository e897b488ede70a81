// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace lightwell::calibration {

// Corners moved to where the picture's edges meet, each in a window that fits between its neighbours.
// neighbours: for each corner the distance to its nearest one, px
void refine_corners(const cv::Mat& grey, const std::vector<double>& neighbour_px,
                    std::vector<cv::Point2f>& corners);

// Where the edges meet near a place, found alike in two windows of different width. Where something else than straight
// edges is in them, they find different places, and there is none; nor where there are less than 2 px of room.
// room: to what else there is, px
std::optional<cv::Point2f> meeting_point(const cv::Mat& grey, cv::Point2f near, double room_px);

// Between the pixels, those at the border go on beyond it.
float code_at(const cv::Mat& grey, cv::Point2f place);

}  // namespace lightwell::calibration
