// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "interface/rig_file.h"
#include "lighting/lens.h"

namespace lightwell::calibration {

// How a camera sees a flat screen: which part of it each pixel shows.
class ScreenView {
 public:
  // By a homography through the rig's marks, of pictures freed of the lens's distortion, or by the pictures' own edges.
  // size: of the pictures; lens: absent where they have no distortion. bad_input: marks on a line, seen by no pixel, or
  // one that lies farther from where the others put it than the rig allows.
  static Result<ScreenView> create(const Rig& rig, const std::optional<Lens>& lens,
                                   const std::array<int, 2>& size, const std::string& file);

  // The four corners of a pixel on the screen, in turn; no numbers where the lens does not see it.
  [[nodiscard]] std::array<Vec2d, 4> corners_m(int x, int y) const {
    return {corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)};
  }
  [[nodiscard]] double mark_rms_px() const { return mark_rms_px_; }

 private:
  [[nodiscard]] const Vec2d& corner(int x, int y) const {
    return corners_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_ + 1) +
                    static_cast<std::size_t>(x)];
  }
  int width_ = 0;
  std::vector<Vec2d> corners_;  // [height + 1][width + 1]
  double mark_rms_px_ = 0;
};

}  // namespace lightwell::calibration
