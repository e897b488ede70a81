// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lighting/radiometer/kernel.h"
#include "lighting/radiometer/pixel_bins.h"

namespace lightwell::radiometer {

// The order in which a frame is binned. Rows are decoded into a window of the last few rows, a batch of them
// at a time; after each batch the cells that are complete are summed while their samples are still in the
// cache. A bin within the window's height and of one group is one cell; any other is several ("parts"), whose
// sums are joined at the end.
struct CellPlan {
  // Columns of the field: window column = sample column − first_column. first_column is even.
  int first_column = 0;
  std::size_t stride = 0;  // of the window and of the per-pixel tables, a multiple of 16
  int window_rows = 0;
  int lanes = 1;

  struct RowSpan {
    std::size_t begin = 0;  // window column, a multiple of 16
    std::size_t count = 0;  // a multiple of 16, 0: the row does not see the field
  };
  std::vector<RowSpan> rows;  // of every sample row

  struct Cells {
    std::vector<CellClass> classes;
    std::vector<std::uint16_t> start;
    std::vector<std::uint8_t> mask;
    // whole: the bin; part: index of the part. Padded to a multiple of 8 a batch with kNone.
    std::vector<std::uint32_t> slot;
    std::vector<std::uint32_t> group;  // whose scale the cell's samples are decoded with, beside slot
    struct Range {
      std::size_t first_class = 0, classes = 0, first_segment = 0, first_cell = 0, cells = 0;
    };
    std::vector<Range> batches;  // one for each batch of rows
  };
  Cells whole;
  Cells parts;
  std::vector<int> batch_end;           // row after the last of each batch
  std::vector<std::uint32_t> part_bin;  // [parts] in the order of bins
  std::size_t largest_batch = 0;        // cells, padded

  [[nodiscard]] std::size_t window_row(int y) const {
    return static_cast<std::size_t>(y % window_rows) * stride;
  }
};

// lanes: longest segment of the kernel; 1 is chosen instead where bins are too narrow for it.
CellPlan plan_cells(const PixelBins& bins, int lanes);

}  // namespace lightwell::radiometer
