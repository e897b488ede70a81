// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <opencv2/core.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "calibration/detection/saddles.h"

namespace lightwell::calibration {

// Saddles that hang together as the corners of checks do: from one to the next runs an edge with light on one side and
// dark on the other.
struct CornerGrid {
  std::map<std::pair<int, int>, Saddle> corners;  // (column, row); rows follow columns as y follows x
  int cells = 0;                                  // checks with all four corners and edges
};

// The grid of most cells in a picture made smaller by `scale` (or larger), in its pixels; empty where no four saddles
// hang together. Edges are looked for in the picture itself, as dots and lines run together to something like checks
// where it is made smaller. The number of saddles bounds the time.
CornerGrid largest_corner_grid(const cv::Mat& grey, double scale);

// Columns and rows of a grid that is a whole rectangle of at least 3 × 3 corners, borders of the background left out.
std::optional<std::pair<int, int>> size_of_grid(CornerGrid grid);

// Whether a grid reaches as far as a board of columns x rows, but for a row and a column; or farther.
bool is_nearly(CornerGrid grid, int columns, int rows);

struct BoardGrid {
  std::vector<cv::Point2f> corners;  // row by row; empty where the grid is of another size
  std::vector<bool> seen;  // whether the picture shows it; else it is where its neighbours have it, roughly
};

// The grid as a board of columns x rows, of which a quarter of the corners may be hidden, if some of each border is
// seen. Borders with less than half of their corners are of the background. The first corner is one with light in the
// quadrant of growing columns and rows where the board tells its ends apart by that, else the one that turns the board
// least.
BoardGrid board_of_grid(CornerGrid grid, int columns, int rows);

}  // namespace lightwell::calibration
