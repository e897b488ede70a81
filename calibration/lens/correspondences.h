// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "lighting/result.h"
#include "lighting/vector.h"

namespace lightwell::calibration {

// A point of the calibration target and the pixel where a picture shows it.
struct Correspondence {
  Vec3d target_mm;  // in the target's own frame; need not lie in a plane
  Vec2d pixel;
};

// One picture of the target.
struct TargetView {
  std::string name;
  std::vector<Correspondence> points;
};

struct TargetViews {
  std::array<int, 2> image_size = {0, 0};  // width, height
  std::vector<TargetView> views;
};

// {"image_size": [w, h], "views": [{"name": …, "points": [[X, Y, Z, u, v], …]}]}, mm and pixels. bad_input
// names file, field and value: numbers that are not finite, places beyond 1e9 mm, pixels further than one image
// outside the image, two views of one name or of the same points, two points of one view at the same place of the
// target, more than 2000 views or 100000 points of one.
Result<TargetViews> read_target_views(const std::filesystem::path& file);
// The same file from what was detected; bytes of a name that are not UTF-8 become U+FFFD.
std::string to_json(const TargetViews& target_views);

}  // namespace lightwell::calibration
