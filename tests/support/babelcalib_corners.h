// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "calibration/lens/correspondences.h"

namespace lightwell::test {

// BabelCalib's corner lists of its ov_plane set, one file a view: lines "board,id,…,u,v", id = 22 y + x, pitch .75.
// Nothing where the folder is not there.
inline std::optional<calibration::TargetViews> babelcalib_corners(const std::filesystem::path& folder) {
  if (!std::filesystem::exists(folder)) return {};
  calibration::TargetViews out{{1280, 800}, {}};
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".orpc") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    calibration::TargetView view{file.filename().string(), {}};
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
      int board = 0, id = 0, state = 0;
      double u = 0, v = 0;
      if (std::sscanf(line.c_str(), "%d,%d,%d,%lf,%lf", &board, &id, &state, &u, &v) == 5)
        view.points.push_back({{0.75 * (id % 22), 0.75 * (id / 22), 0}, {u, v}});
    }
    out.views.push_back(std::move(view));
  }
  return out;
}

}  // namespace lightwell::test
