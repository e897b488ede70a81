// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calibration/detection/board.h"

namespace lightwell::calibration {

// A corner of a board, around which two light and two dark quadrants alternate, as on all boards.
struct BoardCorner {
  Vec3d target_mm;
  // Whether the quadrant of growing x and y is of the first of two colours; which of them is dark, the board says
  // (AprilGrid: the first) or a picture.
  bool first_colour = false;
};

// How far the smallest of a corner's quadrants reaches along x and y, mm.
double quadrant_mm(const Board& board);

// All corners of a board.
// rows_fall: whether the rows of an AprilGrid go on toward falling y
std::vector<BoardCorner> corners_of(const Board& board, bool rows_fall);

}  // namespace lightwell::calibration
