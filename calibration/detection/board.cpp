// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/detection/board.h"

#include <charconv>

namespace lightwell::calibration {
namespace {

template <class T>
bool number(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

const char* text_of(BoardKind kind) {
  switch (kind) {
    case BoardKind::chessboard:
      return "chessboard";
    case BoardKind::charuco:
      return "charuco";
    case BoardKind::aprilgrid:
      return "aprilgrid";
  }
  return "";
}

}  // namespace

Result<Board> board_from_text(const std::string& text) {
  const Error wrong{ErrorKind::usage,
                    "--board is " + text +
                        ", allowed COLSxROWS:PITCH_MM[:chessboard|charuco|aprilgrid] with 2 to 100 "
                        "columns and rows, pitch above 0 to 10000 mm"};
  const auto colon = text.find(':');
  const auto times = text.find('x');
  if (colon == std::string::npos || times == std::string::npos || times > colon) return wrong;
  const auto second = text.find(':', colon + 1);
  const std::string_view all = text;
  Board board;
  if (!number(all.substr(0, times), board.columns) ||
      !number(all.substr(times + 1, colon - times - 1), board.rows) ||
      !number(all.substr(colon + 1, second == std::string::npos ? second : second - colon - 1),
              board.pitch_mm))
    return wrong;
  if (board.columns < 2 || board.columns > 100 || board.rows < 2 || board.rows > 100 ||
      !(board.pitch_mm > 0 && board.pitch_mm <= 10000))
    return wrong;
  if (second != std::string::npos) {
    const std::string_view kind = all.substr(second + 1);
    if (kind == "charuco")
      board.kind = BoardKind::charuco;
    else if (kind == "aprilgrid")
      board.kind = BoardKind::aprilgrid;
    else if (kind != "chessboard")
      return wrong;
  }
  if (board.kind == BoardKind::chessboard && (board.columns < 3 || board.rows < 3))
    return Error{ErrorKind::usage,
                 "--board is " + text + ", allowed for a chessboard: at least 3x3 inner corners"};
  board.marker_mm = board.pitch_mm * (board.kind == BoardKind::aprilgrid ? 1 / 1.3 : 0.75);
  return board;
}

std::string name(const Board& board) {
  return std::to_string(board.columns) + "x" + std::to_string(board.rows) + " " + text_of(board.kind);
}

}  // namespace lightwell::calibration
