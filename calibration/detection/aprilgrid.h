// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "calibration/detection/board.h"
#include "calibration/detection/markers.h"

namespace lightwell::calibration {

// Corners of AprilTags 36h11, to a fraction of a pixel, ids row by row from a corner of the grid as Kalibr prints them
// (either row may come first, black borders of one or two bits). Left out: tags that are not where their neighbours
// have them, and corners that edges do not meet at.
MarkerSearch find_aprilgrid(const cv::Mat& grey, const Board& board);

}  // namespace lightwell::calibration
