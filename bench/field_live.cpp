// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/field_live.h"

#include <cmath>
#include <limits>
#include <memory>

#include "lighting/field/live_field.h"
#include "tests/support/live_stage.h"

namespace lightwell::bench {
namespace {

constexpr std::size_t kProbes = 10;

FieldGrid grid_of_16() {
  return {{16, 16, 16}, Vec3d::Zero(), Vec3d::Ones()};
}

std::vector<PolarMap> maps_of(const test::StageLight& light, const std::vector<Vec3d>& positions) {
  std::vector<PolarMap> maps;
  for (const Vec3d& at : positions) maps.push_back(test::map_at(light, at));
  return maps;
}

// The baseline as a program would have it: harmonics of ten maps, then every grid point from the weights that stand ready.
class ShepardField {
 public:
  explicit ShepardField(const std::vector<Vec3d>& positions) : projection_(PolarGrid{}), sums_(25 * 3, 4096) {
    const FieldGrid grid = grid_of_16();
    weights_.resize(static_cast<Eigen::Index>(kProbes), static_cast<Eigen::Index>(grid.points()));
    Eigen::Index point = 0;
    for (int k = 0; k < 16; ++k)
      for (int j = 0; j < 16; ++j)
        for (int i = 0; i < 16; ++i, ++point) {
          for (std::size_t n = 0; n < kProbes; ++n)
            weights_(static_cast<Eigen::Index>(n), point) =
                static_cast<float>(1 / ((grid.position(i, j, k) - positions[n]).squaredNorm() + 1e-9));
          weights_.col(point) /= weights_.col(point).sum();
        }
  }
  void update(const std::vector<PolarMap>& maps) {
    Eigen::MatrixXf own(25 * 3, static_cast<Eigen::Index>(kProbes));
    for (std::size_t n = 0; n < kProbes; ++n)
      own.col(static_cast<Eigen::Index>(n)) = projection_.project(maps[n]).cast<float>().matrix().reshaped();
    sums_.noalias() = own * weights_;
  }

 private:
  MapHarmonics projection_;
  Eigen::MatrixXf weights_, sums_;
};

struct Errors {
  double baseline = 0, across = 0, live = 0;
};

// Relative RMS of the harmonics at 40 places, over four sets of places of the probes.
Errors errors_of(const test::StageLight& light, bool on_a_table) {
  Errors squares;
  double norm = 0;
  const auto places = test::random_positions(40, 99);
  for (unsigned seed = 1; seed <= 4; ++seed) {
    auto positions = test::random_positions(kProbes, seed);
    if (on_a_table)
      for (Vec3d& p : positions) p.y() = 0.3;
    const auto maps = maps_of(light, positions);
    LiveFieldOptions options;
    options.grid = grid_of_16();
    LiveField live(options, positions);
    options.lamps = false;
    LiveField across(options, positions);
    std::vector<Eigen::MatrixXd> own;
    MapHarmonics projection(PolarGrid{});
    for (std::size_t n = 0; n < kProbes; ++n) {
      own.emplace_back(projection.project(maps[n]).matrix());
      live.update(n, maps[n], 0);
      across.update(n, maps[n], 0);
    }
    const LightField& field = live.make(0);
    const LightField& plain = across.make(0);
    for (const Vec3d& p : places) {
      const Eigen::MatrixXd exact = test::exact_harmonics(light, p);
      squares.baseline += (test::shepard(positions, own, p) - exact).squaredNorm();
      squares.across += (light_at(plain, p).radiance.matrix() - exact).squaredNorm();
      squares.live += (light_at(field, p).radiance.matrix() - exact).squaredNorm();
      norm += exact.squaredNorm();
    }
  }
  return {std::sqrt(squares.baseline / norm), std::sqrt(squares.across / norm),
          std::sqrt(squares.live / norm)};
}

}  // namespace

std::vector<Row> live_rows(const Options& options) {
  const test::LampBall one{{0.6, 1.8, 0.3}, 0.04, Rgbd(20, 18, 15)};
  const std::vector<std::pair<std::string, test::StageLight>> lights = {
      {"linear", {test::linear_field, {}}},
      {"walls", {test::walls, {}}},
      {"beam", {test::beam_edge, {}}},
      {"two area lamps", {test::box_of_lamps, {}}},
      {"walls and a near lamp", {test::walls, {one}}},
      {"walls and three near lamps",
       {test::walls,
        {one, {{-0.4, 1.5, 0.8}, 0.04, Rgbd(10, 12, 15)}, {{1.2, 2.0, 1.3}, 0.03, Rgbd(8, 8, 8)}}}},
      {"walls and two lamps in line",
       {test::walls, {{{0.5, 1.6, 0.5}, 0.04, Rgbd(20, 18, 15)}, {{0.5, 2.4, 0.5}, 0.04, Rgbd(30, 30, 30)}}}},
      {"walls and a lamp inside the grid", {test::walls, {{{0.52, 0.8, 0.47}, 0.03, Rgbd(5, 5, 5)}}}}};
  std::vector<Row> rows;
  for (const auto& [name, light] : lights)
    for (const bool on_a_table : {false, true}) {
      const std::string setting =
          "live, error, " + name + (on_a_table ? ", probes on a table" : ", probes in space");
      const Errors errors = errors_of(light, on_a_table);
      const auto row = [&](const char* which, double error) {
        Row made;
        made.setting = setting;
        made.name = which;
        made.timing.p10_ms = made.timing.p50_ms = made.timing.p99_ms =
            std::numeric_limits<double>::quiet_NaN();
        made.values = {{"sh_rel_rms_error", error}};
        rows.push_back(std::move(made));
      };
      row("harmonics by place (Shepard 1968)", errors.baseline);
      row("across directions, no lamps placed", errors.across);
      row("live", errors.live);
    }
  const auto positions = test::random_positions(kProbes, 1);
  for (const auto& [name, light] : {lights[1], lights[3], lights[5]}) {
    const auto maps = maps_of(light, positions);
    LiveFieldOptions field_options;
    field_options.grid = grid_of_16();
    LiveField live(field_options, positions);
    ShepardField shepard(positions);
    double now_s = 0;
    std::vector<Case> cases;
    cases.push_back({"harmonics by place (Shepard 1968)", [&](std::size_t) { shepard.update(maps); }, {}});
    cases.push_back({"live",
                     [&](std::size_t) {
                       now_s += 1 / 30.0;
                       for (std::size_t n = 0; n < kProbes; ++n) live.update(n, maps[n], now_s);
                       live.make(now_s);
                     },
                     {}});
    for (Row& row :
         time_in_turns("live, update of ten maps 90 x 360 to 16 cubed, " + name, std::move(cases), options))
      rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace lightwell::bench
