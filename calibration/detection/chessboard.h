// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "calibration/detection/board.h"

namespace lightwell::calibration {

struct ChessboardSearch {
  std::vector<cv::Point2f> corners;  // inner ones, row by row; empty where too few of them are found
  std::vector<bool> seen;            // of each, whether it is; else it is about where its neighbours have it
  // Columns and rows of a whole board of another size, beyond which the checks do not go on.
  std::optional<std::pair<int, int>> other_size;
  bool shows_checks = false;  // a third of the board's checks, or twenty, hang together somewhere
};

// A picture without checks costs some tenths of a second a megapixel, whatever its texture.
ChessboardSearch find_chessboard(const cv::Mat& grey, int columns, int rows);

// Whether the checks go on beyond the outermost corners, so that the board has more of them; as those that are seen say.
bool goes_on(const cv::Mat& grey, const std::vector<cv::Point2f>& corners, const std::vector<bool>& seen,
             int columns, int rows);

// Whether a board would show its corners here: black and white are far apart, and the strongest edges are narrower than
// the checks of a board that fills the picture.
bool is_sharp_and_bright(const cv::Mat& grey);

}  // namespace lightwell::calibration
