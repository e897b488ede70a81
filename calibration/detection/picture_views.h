// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calibration/detection/board.h"

namespace lightwell::calibration {

// What pictures of a board show, one view a picture in the order given; a view where the board was not found has
// no points and a reason.
struct PictureViews {
  TargetViews target_views;
  std::vector<std::string> reasons;
};

// done: called with the number of pictures behind it.
// bad_input names the picture: no picture, of another size than the first, sharp and bright and clearly not of a
// chessboard; or says that the board has another size than asked for. A picture too dark or blurred to tell is a view
// without points.
Result<PictureViews> views_of_pictures(const std::vector<std::string>& files, const Board& board,
                                       const std::function<void(std::size_t)>& done);

}  // namespace lightwell::calibration
