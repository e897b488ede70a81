// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The simulated walk's stage as a field at the paper's resolutions: how well its ground shows edges of light and the
// projected pattern (Löw et al. 2009, figures 9 and 11).

#include "bench/field_stage.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <string>
#include <thread>

#include "bench/stage_truth.h"
#include "daemon/simulator/walk_stage.h"
#include "field/parallel_for.h"
#include "lighting/field/direction_estimator.h"

namespace lightwell::bench {
namespace {

constexpr double kWalk_s = 231.2, kProbeRate_hz = 10;
constexpr double kTop_m = 0.3;
constexpr int kDegree = 4;
constexpr int kGroundSide = 200;  // points of the ground a side
constexpr double kEdge_x_m = 0.15, kEdge_z_m = -0.4;

std::vector<Vec3d> places_of_walk() {
  const auto scene = simulator::make_walk_scene();
  std::vector<Vec3d> places;
  for (double t = 0.01; t < kWalk_s; t += 1 / kProbeRate_hz)
    places.push_back(*scene->at(t - 1e-9, t + 1e-9).position_m);
  return places;
}

// What probes at these places see in the directions above the horizon: without a camera, so that only resampling errs.
class SeenStage {
 public:
  SeenStage(std::span<const Vec3d> places, int cells, unsigned threads)
      : probes_(places.size()), sphere_(cells), direction_of_(static_cast<std::size_t>(sphere_.cells()), -1) {
    for (int c = 0; c < sphere_.cells(); ++c) {
      if (!(sphere_.centre(c).y() > 1e-9)) continue;
      direction_of_[static_cast<std::size_t>(c)] = static_cast<int>(directions_.size());
      directions_.push_back({sphere_.centre(c), Vec3d::Zero(), sphere_.cell_solid_angle_sr()});
    }
    radiance_.resize(directions_.size() * probes_);
    parallel_for(probes_, threads, [&](std::size_t p, unsigned) {
      const std::vector<Rgb> seen = look(places[p]);
      for (std::size_t d = 0; d < seen.size(); ++d) radiance_[d * probes_ + p] = seen[d];
    });
  }

  [[nodiscard]] std::span<const MeasuredDirection> directions() const { return directions_; }
  [[nodiscard]] std::span<const Rgb> radiance(std::size_t direction) const {
    return std::span(radiance_).subspan(direction * probes_, probes_);
  }

 private:
  // Each lamp's light is shared out over the cells that it lies in.
  [[nodiscard]] std::vector<Rgb> look(const Vec3d& at) const {
    std::vector<Rgb> seen;
    for (const MeasuredDirection& d : directions_)
      seen.push_back(simulator::stage_wall_radiance(at, d.direction).cast<float>());
    constexpr int kParts = 400;
    for (const simulator::DiscLight& light : simulator::stage_lights(at)) {
      const Rgb part = (light.illuminance / kParts / sphere_.cell_solid_angle_sr()).cast<float>();
      for (const Vec3d& d : simulator::disc_samples(light, kParts))
        if (const int i = direction_of_[static_cast<std::size_t>(sphere_.cell_of(d))]; i >= 0)
          seen[static_cast<std::size_t>(i)] += part;
    }
    return seen;
  }

  std::size_t probes_;
  SpherePartition sphere_;
  std::vector<int> direction_of_;  // a cell's, −1 below the horizon
  std::vector<MeasuredDirection> directions_;
  std::vector<Rgb> radiance_;  // [direction][probe]
};

LightField resample(const SeenStage& stage, std::span<const Vec3d> places, const FieldGrid& grid,
                    FieldMethod method, unsigned threads) {
  const std::size_t count = stage.directions().size();
  SupportChoice choice;
  if (method == FieldMethod::best) {
    DirectionEstimator estimator(grid, places, method, 0);
    for (std::size_t d = 0; d < count; d += 1 + count / 96)
      estimator.hold_out(stage.directions()[d], stage.radiance(d), choice);
  }
  FieldSums sums(grid, kDegree);
  std::vector<DirectionEstimator> estimators(threads,
                                             DirectionEstimator(grid, places, method, choice.best()));
  constexpr std::size_t kBatch = 32;
  for (std::size_t first = 0; first < count; first += kBatch) {
    std::vector<FieldDirection> batch(std::min(kBatch, count - first),
                                      {ShearPlane(grid, Vec3d::UnitY(), 1), {}, {}, 0});
    parallel_for(batch.size(), threads, [&](std::size_t i, unsigned thread) {
      const MeasuredDirection& direction = stage.directions()[first + i];
      estimators[thread].estimate(direction, stage.radiance(first + i), batch[i]);
      Eigen::VectorXd y(harmonic_count(kDegree));
      harmonics(direction.direction, kDegree, y.data());
      batch[i].harmonics = (y * direction.solid_angle_sr).cast<float>();
    });
    parallel_for(static_cast<std::size_t>(sums.slabs()), threads,
                 [&](std::size_t z, unsigned) { sums.add(batch, static_cast<int>(z)); });
  }
  return std::move(sums).take();
}

Rgbd ground_irradiance(const LightField& field, double x, double z) {
  return irradiance(light_at(field, {x, 0, z}), Vec3d::UnitY());
}

double ground_error(const LightField& field, const StageTruth& truth) {
  double error = 0, norm = 0;
  const auto place = [](int i) { return simulator::kWalkHalf_m * ((2.0 * i + 1) / kGroundSide - 1); };
  for (int j = 0; j < kGroundSide; ++j)
    for (int i = 0; i < kGroundSide; ++i) {
      const Rgbd exact = truth.irradiance(place(i), place(j));
      error += (ground_irradiance(field, place(i), place(j)) - exact).square().sum();
      norm += exact.square().sum();
    }
  return std::sqrt(error / norm);
}

// From 10 to 90 % of the step across the edge of the blocked spot, metres.
double spot_edge_m(const LightField& field) {
  const auto level = [&](double x) { return ground_irradiance(field, x, kEdge_z_m)[0]; };
  const double dark = level(kEdge_x_m - 0.3), lit = level(kEdge_x_m + 0.3);
  double first_above_10 = kEdge_x_m + 0.3, first_above_90 = first_above_10;
  for (double x = kEdge_x_m + 0.3; x >= kEdge_x_m - 0.3; x -= 2e-4) {
    const double part = (level(x) - dark) / (lit - dark);
    if (part > 0.9) first_above_90 = x;
    if (part > 0.1) first_above_10 = x;
  }
  return first_above_90 - first_above_10;
}

}  // namespace

std::vector<Row> stage_rows() {
  const unsigned threads = std::max(1u, std::thread::hardware_concurrency());
  const std::vector<Vec3d> places = places_of_walk();
  const StageTruth truth;
  std::vector<Row> rows;
  for (const int side : {8, 16, 32, 64}) {
    const FieldGrid grid{{side, side, side},
                         Vec3d(-simulator::kWalkHalf_m, 0, -simulator::kWalkHalf_m),
                         Vec3d(simulator::kWalkHalf_m, kTop_m, simulator::kWalkHalf_m)};
    const SeenStage stage(places, direction_count_for(grid), threads);
    for (const FieldMethod method : {FieldMethod::low, FieldMethod::best}) {
      Row row;
      row.setting = "stage walk, ground, " + std::to_string(places.size()) + " probes, " +
                    std::to_string(side) + " cubed";
      row.name = method == FieldMethod::low ? "low" : "best";
      const auto begin = std::chrono::steady_clock::now();
      const LightField field = resample(stage, places, grid, method, threads);
      row.timing.p10_ms = std::numeric_limits<double>::quiet_NaN();
      row.timing.p50_ms = row.timing.p99_ms =
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
      row.timing.runs = 1;
      const double edge_m = spot_edge_m(field);
      row.values = {{"irradiance_rel_rms_error", ground_error(field, truth)},
                    {"edge_10_90_cells", edge_m / grid.cell().x()},
                    {"edge_10_90_mm", 1000 * edge_m},
                    {"threads", threads}};
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

}  // namespace lightwell::bench
