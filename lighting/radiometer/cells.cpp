// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/radiometer/cells.h"

#include <algorithm>
#include <utility>

namespace lightwell::radiometer {
namespace {

// What a 16 bit index reaches, 256 KB, at home in a second level cache; less the zeros behind the window.
constexpr std::size_t kWindowFloats = 65536 - kWindowZeros;
constexpr int kMostWindowRows = 64;
// Segments pay from this many samples a run on (measured: bench/frame_suite.cpp); below, lists of single
// pixels.
constexpr double kShortRun = 4.5;

// Neighbours of one row in one group.
struct Run {
  std::uint32_t group;
  int y, x, length;
};

std::vector<Run> find_runs(const PixelBins& bins) {
  std::vector<Run> runs;
  for (int y = 0; y < bins.height; ++y) {
    const std::uint32_t* row = bins.group.data() + static_cast<std::ptrdiff_t>(y) * bins.width;
    for (int x = 0; x < bins.width;) {
      int end = x + 1;
      while (end < bins.width && row[end] == row[x]) ++end;
      if (row[x] != kNone) runs.push_back({row[x], y, x, end - x});
      x = end;
    }
  }
  return runs;
}

void plan_window(const PixelBins& bins, const std::vector<Run>& runs, CellPlan& plan) {
  int left = bins.width;
  int right = 0;
  for (const Run& r : runs) {
    left = std::min(left, r.x);
    right = std::max(right, r.x + r.length);
  }
  plan.first_column = left & ~1;
  plan.stride = static_cast<std::size_t>(right - plan.first_column + 15) / 16 * 16;
  plan.window_rows =
      static_cast<int>(std::clamp<std::size_t>(kWindowFloats / plan.stride, 2, kMostWindowRows));
  plan.rows.assign(static_cast<std::size_t>(bins.height), {});
  for (const Run& r : runs) {
    CellPlan::RowSpan& span = plan.rows[static_cast<std::size_t>(r.y)];
    const auto begin = static_cast<std::size_t>(r.x - plan.first_column) / 16 * 16;
    const auto end = (static_cast<std::size_t>(r.x + r.length - plan.first_column) + 15) / 16 * 16;
    if (span.count == 0) span.begin = begin;  // runs come in order
    span.count = end - span.begin;
  }
}

// One cell before it is laid out.
struct Cell {
  std::uint32_t bin, group;
  int first_row, last_row;
  std::vector<std::pair<std::uint16_t, std::uint8_t>> segments;  // start, length
};

void add_run(const CellPlan& plan, Cell& cell, const Run& run) {
  for (int done = 0; done < run.length; done += plan.lanes) {
    const auto start = plan.window_row(run.y) + static_cast<std::size_t>(run.x + done - plan.first_column);
    cell.segments.emplace_back(static_cast<std::uint16_t>(start),
                               static_cast<std::uint8_t>(std::min(plan.lanes, run.length - done)));
  }
  cell.last_row = run.y;
}

// Cells of every bin, of one group each and none higher than the rows that stay in the window while a batch
// is decoded.
std::vector<std::vector<Cell>> make_cells(const PixelBins& bins, const std::vector<Run>& runs,
                                          const CellPlan& plan, int batch_rows) {
  const int highest = plan.window_rows - batch_rows + 1;
  std::vector<std::vector<Cell>> cells(bins.bin_sr.size());
  for (const Run& r : runs) {
    const std::uint32_t bin = bins.bin_of_group[r.group];
    auto& of_bin = cells[bin];
    const auto open =
        std::find_if(of_bin.rbegin(), of_bin.rend(), [&](const Cell& c) { return c.group == r.group; });
    if (open != of_bin.rend() && r.y - open->first_row < highest) {
      add_run(plan, *open, r);
    } else {
      of_bin.push_back({bin, r.group, r.y, r.y, {}});
      add_run(plan, of_bin.back(), r);
    }
  }
  for (std::uint32_t bin = 0; bin < cells.size(); ++bin)
    if (const std::uint32_t sample = bins.nearest[bin]; sample != kNone) {
      const int y = static_cast<int>(sample) / bins.width;
      const int x = static_cast<int>(sample) % bins.width;
      cells[bin].push_back({bin, bins.group[sample], y, y, {}});
      add_run(plan, cells[bin].back(), {bins.group[sample], y, x, 1});
    }
  return cells;
}

// One class for each number of segments, the segments of a cell after each other.
void lay_out_segments(const CellPlan& plan, const std::vector<std::pair<std::uint32_t, const Cell*>>& batch,
                      CellPlan::Cells& out) {
  const std::size_t first_class = out.classes.size();
  for (const auto& [slot, cell] : batch) {
    const auto segments = static_cast<std::uint32_t>(cell->segments.size());
    if (out.classes.size() == first_class || out.classes.back().segments != segments)
      out.classes.push_back({segments, 0});
    ++out.classes.back().cells;
    for (const auto& [start, length] : cell->segments) {
      out.start.push_back(start);
      out.mask.push_back(static_cast<std::uint8_t>((length - 1) * plan.lanes * 4));
    }
  }
}

// One class for every eight cells, their pixels side by side; short cells are filled with the zeros behind
// the window.
void lay_out_pixels(const CellPlan& plan, const std::vector<std::pair<std::uint32_t, const Cell*>>& batch,
                    CellPlan::Cells& out) {
  const auto zero = static_cast<std::uint16_t>(static_cast<std::size_t>(plan.window_rows) * plan.stride);
  for (std::size_t first = 0; first < batch.size(); first += 8) {
    const std::size_t cells = std::min<std::size_t>(8, batch.size() - first);
    const std::size_t longest = batch[first + cells - 1].second->segments.size();  // they stand sorted
    out.classes.push_back({static_cast<std::uint32_t>(longest), 8});
    for (std::size_t i = 0; i < longest; ++i)
      for (std::size_t lane = 0; lane < 8; ++lane) {
        const bool there = lane < cells && i < batch[first + lane].second->segments.size();
        out.start.push_back(there ? batch[first + lane].second->segments[i].first : zero);
        out.mask.push_back(0);
      }
  }
}

void lay_out(const CellPlan& plan, std::vector<std::pair<std::uint32_t, const Cell*>>& batch,
             CellPlan::Cells& out) {
  std::stable_sort(batch.begin(), batch.end(), [](const auto& a, const auto& b) {
    return a.second->segments.size() < b.second->segments.size();
  });
  CellPlan::Cells::Range range;
  range.first_class = out.classes.size();
  range.first_segment = out.start.size();
  range.first_cell = out.slot.size();
  range.cells = batch.size();
  (plan.lanes == 1 ? lay_out_pixels : lay_out_segments)(plan, batch, out);
  range.classes = out.classes.size() - range.first_class;
  for (const auto& [slot, cell] : batch) {
    out.slot.push_back(slot);
    out.group.push_back(cell->group);
  }
  out.slot.resize((out.slot.size() + 7) / 8 * 8, kNone);  // padding, never written through
  out.group.resize(out.slot.size(), kNone);
  out.batches.push_back(range);
}

}  // namespace

CellPlan plan_cells(const PixelBins& bins, int lanes) {
  CellPlan plan;
  const std::vector<Run> runs = find_runs(bins);
  std::size_t samples = 0;
  for (const Run& r : runs) samples += static_cast<std::size_t>(r.length);
  plan.lanes = static_cast<double>(samples) < kShortRun * static_cast<double>(runs.size()) ? 1 : lanes;
  plan_window(bins, runs, plan);
  const int batch_rows = std::clamp(plan.window_rows / 4, 1, 8);
  const auto cells = make_cells(bins, runs, plan, batch_rows);

  const auto batches = static_cast<std::size_t>((bins.height + batch_rows - 1) / batch_rows);
  std::vector<std::vector<std::pair<std::uint32_t, const Cell*>>> whole(batches);
  auto parts = whole;
  for (const auto& of_bin : cells)
    for (const Cell& cell : of_bin) {
      const auto batch = static_cast<std::size_t>(cell.last_row / batch_rows);
      if (of_bin.size() == 1) {
        whole[batch].emplace_back(cell.bin, &cell);
      } else {
        parts[batch].emplace_back(static_cast<std::uint32_t>(plan.part_bin.size()), &cell);
        plan.part_bin.push_back(cell.bin);
      }
    }
  for (std::size_t b = 0; b < batches; ++b) {
    lay_out(plan, whole[b], plan.whole);
    lay_out(plan, parts[b], plan.parts);
    plan.batch_end.push_back(std::min(bins.height, static_cast<int>(b + 1) * batch_rows));
    plan.largest_batch = std::max({plan.largest_batch, whole[b].size(), parts[b].size()});
  }
  plan.largest_batch = (plan.largest_batch + 7) / 8 * 8;
  return plan;
}

}  // namespace lightwell::radiometer
