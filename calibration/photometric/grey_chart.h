// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibration/photometric/mean_frame.h"
#include "lighting/lens.h"

// Where the patches of known luminance lie in the frames.
namespace lightwell::calibration {

// A chart of square cells: columns × (rows + 2). The first and the last row hold a marker each in their first and last
// cell (ArUco 4X4_50, ids 0 top left, 1 top right, 2 bottom right, 3 bottom left, 3/4 of a cell wide, in its middle), the
// rows between hold the patches, numbered from 1, row by row from the top left.
struct GreyChart {
  int columns = 6, rows = 2;
  [[nodiscard]] int patches() const { return columns * rows; }
};
// "6x2"; usage error with what is allowed: 2x1 to 20x20.
Result<GreyChart> chart_from_text(const std::string& text);

// What is printed black, in cells from the chart's top left corner.
struct ChartSquare {
  double x = 0, y = 0, size = 0;
};
std::vector<ChartSquare> black_squares(const GreyChart& chart);
// The chart for the printer: black squares, and patches in greys from white to black with their numbers, cards may be
// glued over them. cell_mm: width of a cell.
std::string chart_svg(const GreyChart& chart, double cell_mm);

// The part of a patch to be measured: a quadrilateral, its corners one after the other.
struct PatchRegion {
  std::string patch;
  std::array<Vec2d, 4> corners;
};

// CSV patch,x,y,w,h: its name, its top left pixel, width and height in pixels. bad_input: see CsvTable; one patch twice.
Result<std::vector<PatchRegion>> read_positions(const std::filesystem::path& file);

// The middle halves of the chart's patches. Without a lens the chart has to look plane: small, or in the middle.
// bad_input: markers are missing, or do not lie as on the chart.
Result<std::vector<PatchRegion>> find_chart(const MeanFrame& frame, const GreyChart& chart,
                                            const std::optional<Lens>& lens);

}  // namespace lightwell::calibration
