// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "calibration/detection/board.h"
#include "calibration/lens/correspondences.h"

namespace lightwell::calibration {

// What was found and what hangs together with it: a lens is fitted to this one picture, its next corners are looked for
// where it puts them, and so on. Each is borne out by the picture: edges meet there, found alike in two windows, and two
// light and two dark quadrants alternate as on the board. found: as corners_of has them; returned alone where there are too few for a lens.
std::vector<Correspondence> with_neighbours(const cv::Mat& grey, const Board& board,
                                            std::vector<Correspondence> found);

}  // namespace lightwell::calibration
