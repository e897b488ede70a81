// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "calibration/detection/board.h"

namespace lightwell::calibration {

struct MarkerCorner {
  Vec3d target_mm;
  cv::Point2f pixel;
};

// What a picture shows of a board with markers.
struct MarkerSearch {
  std::vector<MarkerCorner> corners;
  std::string reason;             // why none
  bool of_another_board = false;  // markers of other ids, of another kind, or in other places
};

// Corners of the checks between ArUco markers; whichever of ArUco's usual dictionaries the picture shows, and, with even
// rows, whichever of the two layouts that OpenCV has printed. A marker seen in two places is left out, and a corner that
// the picture does not bear out between its markers.
MarkerSearch find_charuco(const cv::Mat& grey, const Board& board);

// Markers that say what board a picture shows; fewer are found by chance, or stand behind it.
constexpr std::size_t kTellingMarkers = 3;

// Markers of the kinds that a board has not, the kind of which most are seen; of at least kTellingMarkers, and of more
// than frames with random bits would be read as.
struct OtherMarkers {
  std::size_t count = 0;
  std::string name;  // "AprilTags 25h9"
};
OtherMarkers other_markers(const cv::Mat& grey, BoardKind kind);

// "1, 2, 3 and 7 more"
std::string ids_in_words(const std::vector<int>& ids);

}  // namespace lightwell::calibration
