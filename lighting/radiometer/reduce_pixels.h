// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lighting/radiometer/kernel.h"

// Sums and maxima of cells whose segments are single pixels: loops of a length known at compile time for the
// short lists that most cells have. Included by each kernel file, with internal linkage: see kernel.h.
namespace lightwell::radiometer {
namespace {

template <std::uint32_t kCount>
void sum_cells(const std::uint16_t* start, std::uint32_t cells, const float* window, float* sum,
               float* peak) {
  for (std::uint32_t cell = 0; cell < cells; ++cell, start += kCount) {
    float even = window[start[0]];
    float odd = 0;
    float top = even;
#pragma GCC unroll 16
    for (std::uint32_t i = 1; i < kCount; ++i) {
      const float value = window[start[i]];
      (i % 2 ? odd : even) += value;
      top = value > top ? value : top;
    }
    sum[cell] = even + odd;
    peak[cell] = top;
  }
}

inline void sum_cells_any(const std::uint16_t* start, std::uint32_t count, std::uint32_t cells,
                          const float* window, float* sum, float* peak) {
  for (std::uint32_t cell = 0; cell < cells; ++cell) {
    float total[4] = {0, 0, 0, 0};  // four chains hide the latency of addition
    float top = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const float value = window[start[i]];
      total[i % 4] += value;
      top = value > top ? value : top;
    }
    sum[cell] = (total[0] + total[1]) + (total[2] + total[3]);
    peak[cell] = top;
    start += count;
  }
}

using SumCells = void (*)(const std::uint16_t*, std::uint32_t, const float*, float*, float*);
constexpr SumCells kSumCells[] = {nullptr,       sum_cells<1>,  sum_cells<2>,  sum_cells<3>,  sum_cells<4>,
                                  sum_cells<5>,  sum_cells<6>,  sum_cells<7>,  sum_cells<8>,  sum_cells<9>,
                                  sum_cells<10>, sum_cells<11>, sum_cells<12>, sum_cells<13>, sum_cells<14>,
                                  sum_cells<15>, sum_cells<16>};
constexpr std::uint32_t kUnrolled = sizeof kSumCells / sizeof kSumCells[0];

// Leaves sum and peak of every cell in scratch, one float each.
inline void sum_pixel_cells(const CellBatch& batch, const float* window, const CellScratch& scratch) {
  const std::uint16_t* start = batch.start;
  float* sum = scratch.sum;
  float* peak = scratch.peak;
  for (std::size_t c = 0; c < batch.class_count; ++c) {
    const CellClass& cls = batch.classes[c];
    if (cls.segments < kUnrolled)
      kSumCells[cls.segments](start, cls.cells, window, sum, peak);
    else
      sum_cells_any(start, cls.segments, cls.cells, window, sum, peak);
    start += static_cast<std::size_t>(cls.segments) * cls.cells;
    sum += cls.cells;
    peak += cls.cells;
  }
}

}  // namespace
}  // namespace lightwell::radiometer
