// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>

#include "calibration/detection/aprilgrid.h"
#include "calibration/detection/board.h"
#include "calibration/detection/chessboard.h"
#include "calibration/detection/corner_refinement.h"
#include "calibration/detection/guided_search.h"
#include "calibration/detection/markers.h"

namespace lightwell::calibration {
namespace {

// Distance of each corner to its nearest other.
std::vector<double> nearest_px(const std::vector<cv::Point2f>& corners) {
  std::vector<double> out(corners.size(), std::numeric_limits<double>::max());
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t j = 0; j < corners.size(); ++j)
      if (i != j) out[i] = std::min(out[i], cv::norm(corners[i] - corners[j]));
  return out;
}

// The hidden ones stay where they are guessed: a search would move them to the edge of what hides them.
void refine_seen(const cv::Mat& grey, ChessboardSearch& search) {
  std::vector<cv::Point2f> seen;
  for (std::size_t i = 0; i < search.corners.size(); ++i)
    if (search.seen[i]) seen.push_back(search.corners[i]);
  refine_corners(grey, nearest_px(seen), seen);
  auto next = seen.begin();
  for (std::size_t i = 0; i < search.corners.size(); ++i)
    if (search.seen[i]) search.corners[i] = *next++;
}

Detection chessboard(const cv::Mat& grey, const Board& board) {
  Detection out;
  ChessboardSearch search = find_chessboard(grey, board.columns, board.rows);
  const std::vector<cv::Point2f>& corners = search.corners;
  if (corners.empty()) {
    // Checks would show in a sharp and bright picture even where some are hidden.
    out.of_no_board = !search.shows_checks && is_sharp_and_bright(grey);
    out.other_size = search.other_size;
    if (out.other_size) {
      out.reason = "no whole " + name(board) + " found but one of " + std::to_string(out.other_size->first) +
                   "x" + std::to_string(out.other_size->second) + " inner corners";
      return out;
    }
    out.reason = out.of_no_board ? "shows no chessboard" : "no whole " + name(board) + " found";
    return out;
  }
  refine_seen(grey, search);
  out.board_is_larger = goes_on(grey, corners, search.seen, board.columns, board.rows);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!search.seen[i]) continue;
    const auto column = static_cast<double>(i % static_cast<std::size_t>(board.columns));
    const auto row = static_cast<double>(i / static_cast<std::size_t>(board.columns));
    out.points.push_back({{board.pitch_mm * column, board.pitch_mm * row, 0}, {corners[i].x, corners[i].y}});
  }
  if (out.points.size() < corners.size()) out.points = with_neighbours(grey, board, std::move(out.points));
  return out;
}

Detection markers(const cv::Mat& grey, const Board& board) {
  Detection out;
  const MarkerSearch search =
      board.kind == BoardKind::charuco ? find_charuco(grey, board) : find_aprilgrid(grey, board);
  out.reason = search.reason;
  out.of_no_board = search.of_another_board;
  for (const MarkerCorner& corner : search.corners)
    out.points.push_back({corner.target_mm, {corner.pixel.x, corner.pixel.y}});
  out.points = with_neighbours(grey, board, std::move(out.points));
  return out;
}

}  // namespace

Detection detect_board(const GreyPicture& picture, const Board& board) {
  const cv::Mat grey(picture.height, picture.width, CV_8U, const_cast<std::uint8_t*>(picture.pixels.data()));
  return board.kind == BoardKind::chessboard ? chessboard(grey, board) : markers(grey, board);
}

}  // namespace lightwell::calibration
