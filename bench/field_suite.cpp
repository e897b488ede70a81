// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Incident light fields: time and error against the paper's own algorithm, growth, and the shape of its first scene.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include "bench/field_live.h"
#include "bench/field_rows.h"
#include "bench/field_stage.h"
#include "bench/splat_in_space.h"
#include "bench/suite.h"
#include "tests/support/analytic_fields.h"

namespace lightwell::bench {
namespace {

LightField splat_in_space(const test::AnalyticField& truth, const FieldGrid& grid,
                          std::span<const Vec3d> positions, const DirectionBins& bins, int degree) {
  SplatInSpace splat(grid, degree);
  for (std::size_t d = 0; d < bins.directions().size(); ++d) {
    const auto column = bins.harmonics().col(static_cast<Eigen::Index>(d));
    splat.add(bins.directions()[d], positions, test::seen(truth, positions, bins.directions()[d]),
              column.cast<float>());
  }
  return splat.field();
}

// From 90 to 10 % of the step across a beam's edge at x = ½, in cells: the mean light along a line through the cube's middle.
double edge_width_cells(const LightField& field) {
  const auto level = [&](double x) { return light_at(field, {x, 0.5, 0.5}).radiance(0, 0); };
  const double lit = level(0.2), dark = level(0.8);
  double last_above_90 = 0, last_above_10 = 0;
  for (double x = 0.2; x <= 0.8; x += 2e-4) {
    const double part = (level(x) - dark) / (lit - dark);
    if (part > 0.9) last_above_90 = x;
    if (part > 0.1) last_above_10 = x;
  }
  return (last_above_10 - last_above_90) * (field.grid.size[0] - 1);
}

// Errors at points between grid points, 1000 probes, 16³; the time is that of the whole, one thread.
std::vector<Row> error_rows_of_fields() {
  const FieldGrid grid = unit_cube(16);
  const auto positions = test::random_positions(1000, 1);
  const DirectionBins bins(LatLongProbe{}, 256, 128, direction_count_for(grid), 4);
  const std::vector<std::pair<std::string, test::AnalyticField>> truths = {
      {"linear", test::linear_field}, {"box of two lamps", test::box_of_lamps}, {"beam", test::beam_edge}};
  std::vector<Row> rows;
  for (const auto& [name, truth] : truths)
    for (const std::string method : {"splat in space (Löw 2009)", "low", "best"}) {
      Row row = row_of_one_run("error, " + name + ", 1000 probes, 16 cubed", method, 0);
      const auto begin = std::chrono::steady_clock::now();
      const LightField field =
          method == "low"    ? test::build_field(truth, grid, positions, bins, 4, FieldMethod::low).field
          : method == "best" ? test::build_field(truth, grid, positions, bins, 4, FieldMethod::best).field
                             : splat_in_space(truth, grid, positions, bins, 4);
      row.timing.p50_ms = row.timing.p99_ms =
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
      row.values.emplace_back("sh_rel_rms_error", test::harmonics_error(field, truth, 40));
      if (name == "beam") row.values.emplace_back("edge_10_90_cells", edge_width_cells(field));
      rows.push_back(std::move(row));
    }
  return rows;
}

// One direction of a tenth of the paper's first scene, one thread: 440 probes, 64³, degree 4.
std::vector<Row> direction_rows(const Options& options) {
  const FieldGrid grid = unit_cube(64);
  const auto positions = test::random_positions(440, 1);
  const DirectionBins bins(LatLongProbe{}, 256, 128, 1000, 4);
  std::vector<std::vector<Rgb>> seen;
  for (const MeasuredDirection& d : bins.directions())
    seen.push_back(test::seen(test::box_of_lamps, positions, d));
  const auto pick = [&](std::size_t i) {
    return (i * 379) % bins.directions().size();
  };  // all over the sphere
  SplatInSpace splat(grid, 4);
  std::vector<Case> cases;
  cases.push_back({"splat in space (Löw 2009)",
                   [&](std::size_t i) {
                     const std::size_t d = pick(i);
                     splat.add(bins.directions()[d], positions, seen[d],
                               bins.harmonics().col(static_cast<Eigen::Index>(d)).cast<float>());
                   },
                   {}});
  // Ours take directions in batches, as a build does.
  constexpr std::size_t kBatch = 32;
  std::vector<FieldSums> sums(2, FieldSums(grid, 4));
  for (const FieldMethod method : {FieldMethod::low, FieldMethod::best})
    cases.push_back({std::string(method == FieldMethod::low ? "low" : "best") + ", a batch of 32",
                     [&, method](std::size_t i) {
                       DirectionEstimator estimator(grid, positions, method, 13);
                       std::vector<FieldDirection> batch;
                       for (std::size_t k = 0; k < kBatch; ++k) {
                         const std::size_t d = pick(i * kBatch + k);
                         batch.push_back({ShearPlane(grid, Vec3d::UnitY(), 1), {}, {}, 0});
                         estimator.estimate(bins.directions()[d], seen[d], batch.back());
                         batch.back().harmonics =
                             bins.harmonics().col(static_cast<Eigen::Index>(d)).cast<float>();
                       }
                       FieldSums& out = sums[method == FieldMethod::low ? 0 : 1];
                       for (int z = 0; z < out.slabs(); ++z) out.add(batch, z);
                     },
                     {}});
  std::vector<Row> rows =
      time_in_turns("directions, 440 probes, 64 cubed, one thread", std::move(cases), options, "", {1, 3});
  for (std::size_t i = 0; i < rows.size(); ++i)
    rows[i].values.emplace_back("ratio_of_paper_to_this_a_direction",
                                rows[0].timing.p50_ms / (rows[i].timing.p50_ms / (i == 0 ? 1.0 : kBatch)));
  return rows;
}

}  // namespace

std::vector<Row> field_suite(const Options& options) {
  std::vector<Row> rows = error_rows_of_fields();
  for (Row& row : direction_rows(options)) rows.push_back(std::move(row));
  for (Row& row : stage_rows()) rows.push_back(std::move(row));
  for (Row& row : live_rows(options)) rows.push_back(std::move(row));
  for (Row& row : pipeline_rows(options)) rows.push_back(std::move(row));
  for (Row& row : field_precision_rows()) rows.push_back(std::move(row));
  for (Row& row : field_growth_rows(options)) rows.push_back(std::move(row));
  return rows;
}

}  // namespace lightwell::bench
