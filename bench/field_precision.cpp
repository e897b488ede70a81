// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdio>

#include "bench/field_rows.h"
#include "bench/temporary_folder.h"
#include "interface/field_file.h"
#include "lighting/field/light_field.h"
#include "tests/support/analytic_fields.h"

namespace lightwell::bench {
namespace {

LightField box_field(int side) {
  const DirectionBins bins(LatLongProbe{}, 256, 128, direction_count_for(unit_cube(side)), 4);
  return test::build_field(test::box_of_lamps, unit_cube(side), test::random_positions(1000, 1), bins, 4,
                           FieldMethod::best)
      .field;
}

std::vector<Row> size_rows(const LightField& field) {
  const TemporaryFolder folder;
  std::vector<Row> rows;
  for (const double bound : {0.0, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1}) {
    char name[40];
    std::snprintf(name, sizeof name, "--max-error %g", bound);
    const auto begin = std::chrono::steady_clock::now();
    const auto file = write_field(folder.path() / "f.vdb", field, {"best", bound});
    verify_bug(file.ok(), "bench: a field cannot be written");
    rows.push_back(row_of_one_run(
        "size against error, box of two lamps, 32 cubed", name,
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count()));
    rows.back().values = {{"megabytes", static_cast<double>(file->bytes) / 1e6},
                          {"stored_points", static_cast<double>(file->stored_points)},
                          {"rms_error", file->rms_error},
                          {"most_error", file->most_error}};
  }
  return rows;
}

// Against the integral of radiance times cosine, over points and normals; mean and largest of |error| over the mean.
Row irradiance_row(const std::string& name, const std::function<LightAtPoint(const Vec3d&)>& light_of) {
  const auto begin = std::chrono::steady_clock::now();
  const SpherePartition sphere(20000), normals(40);
  double sum = 0, most = 0, exact_sum = 0;
  int count = 0;
  for (const Vec3d& at : test::random_positions(20, 99)) {
    const LightAtPoint light = light_of(at);
    for (int n = 0; n < normals.cells(); ++n) {
      Rgbd exact = Rgbd::Zero();
      for (int d = 0; d < sphere.cells(); ++d) {
        const Vec3d direction = sphere.centre(d);
        const double cosine = direction.dot(normals.centre(n));
        if (cosine > 0) exact += sphere.cell_solid_angle_sr() * cosine * test::box_of_lamps(at, direction);
      }
      const Rgbd error = (irradiance(light, normals.centre(n)) - exact).abs();
      sum += error.mean();
      most = std::max(most, (error / exact).maxCoeff());
      exact_sum += exact.mean();
      ++count;
    }
  }
  Row row = row_of_one_run(
      "irradiance of degree 4 against the exact integral, box of two lamps", name,
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
  row.values = {
      {"mean_rel_error", sum / exact_sum}, {"max_rel_error", most}, {"normals", static_cast<double>(count)}};
  return row;
}

}  // namespace

std::vector<Row> field_precision_rows() {
  const LightField field = box_field(32);
  std::vector<Row> rows = size_rows(field);
  rows.push_back(irradiance_row("exact harmonics", [](const Vec3d& at) {
    return LightAtPoint{test::exact_harmonics(test::box_of_lamps, at, 4, 20000).array(), 1};
  }));
  rows.push_back(
      irradiance_row("best, 1000 probes, 32 cubed", [&](const Vec3d& at) { return light_at(field, at); }));
  return rows;
}

}  // namespace lightwell::bench
