// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/detection/board_corners.h"

namespace lightwell::calibration {
namespace {

// Of checks: inner corners in rows and columns.
std::vector<BoardCorner> corners_of_checks(int columns, int rows, double pitch_mm) {
  std::vector<BoardCorner> out;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) out.push_back({{pitch_mm * c, pitch_mm * r, 0}, (c + r) % 2 == 0});
  return out;
}

std::vector<BoardCorner> corners_of_tags(const Board& board, bool rows_fall) {
  const double side = board.marker_mm;
  std::vector<BoardCorner> out;
  for (int r = 0; r < board.rows; ++r)
    for (int c = 0; c < board.columns; ++c) {
      const Vec3d first(board.pitch_mm * c, (rows_fall ? -1 : 1) * board.pitch_mm * r, 0);
      // A tag is dark inside, and so is what lies across its corners.
      for (const bool far_x : {false, true})
        for (const bool far_y : {false, true})
          out.push_back({first + Vec3d(far_x ? side : 0, far_y ? side : 0, 0), far_x == far_y});
    }
  return out;
}

}  // namespace

double quadrant_mm(const Board& board) {
  switch (board.kind) {
    case BoardKind::chessboard:
      return board.pitch_mm;
    case BoardKind::charuco:
      return (board.pitch_mm - board.marker_mm) / 2;
    case BoardKind::aprilgrid:
      return board.pitch_mm - board.marker_mm;
  }
  return 0;
}

std::vector<BoardCorner> corners_of(const Board& board, bool rows_fall) {
  switch (board.kind) {
    case BoardKind::chessboard:
      return corners_of_checks(board.columns, board.rows, board.pitch_mm);
    case BoardKind::charuco:
      return corners_of_checks(board.columns - 1, board.rows - 1, board.pitch_mm);
    case BoardKind::aprilgrid:
      return corners_of_tags(board, rows_fall);
  }
  return {};
}

}  // namespace lightwell::calibration
