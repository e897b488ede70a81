// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibration/detection/picture_file.h"
#include "calibration/lens/correspondences.h"

namespace lightwell::calibration {

enum class BoardKind { chessboard, charuco, aprilgrid };

// A printed calibration target.
struct Board {
  BoardKind kind = BoardKind::chessboard;
  int columns = 0;  // chessboard: inner corners; ChArUco: squares; AprilGrid: tags
  int rows = 0;
  double pitch_mm = 0;  // from corner to corner, square to square, tag to tag
  double marker_mm =
      0;  // side of a marker; ChArUco: 3/4 of the pitch, AprilGrid: pitch / 1.3 (Kalibr's default)
};

// "9x6:30", "5x7:40:charuco", "6x6:71.5:aprilgrid"; usage error with what is allowed.
Result<Board> board_from_text(const std::string& text);
// "9x6 chessboard"
std::string name(const Board& board);

// What a picture shows of the board.
struct Detection {
  std::vector<Correspondence> points;  // empty: not found
  std::string reason;                  // why not
  // Sharp and bright, and not even corners such as a chessboard has; or markers, but not those of the board.
  bool of_no_board = false;
  // Inner corners of the whole chessboard that it shows instead.
  std::optional<std::pair<int, int>> other_size;
  bool board_is_larger = false;  // a chessboard that goes on beyond its columns or rows
};

// Finds the board at several scales and refines its corners to a fraction of a pixel.
Detection detect_board(const GreyPicture& picture, const Board& board);

}  // namespace lightwell::calibration
