// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Lamps: what the forms of a measured lamp err and cost, near and far, and lamps made of rays.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <random>
#include <string>

#include "bench/chart.h"
#include "bench/field_rows.h"
#include "bench/lamp_location_rows.h"
#include "bench/suite.h"
#include "calibration/luminaire/lamp_build.h"
#include "interface/plain_ray_file.h"
#include "interface/ray_file.h"
#include "lighting/luminaire/far_projection.h"
#include "tests/support/simulated_rig.h"

namespace lightwell::bench {
namespace {

constexpr const char* kForms = "forms of a measured lamp";
constexpr const char* kRays = "planes lit by imported rays";

double ms_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

// The reflector with its filament, as a rig measures it: spacing a tenth of the planes' distance, 180² pixels.
Row build_row(test::SimulatedRig& rig, calibration::BuiltLamp& built) {
  rig.slides = false;
  rig.list_pictures();
  double outside_ms = 0;  // that the simulated rig takes for its pictures
  const auto begin = std::chrono::steady_clock::now();
  auto lamp = calibration::build_lamp(rig.rig, "", [&](const std::string& file) -> Result<LatLongImage> {
    const auto asked = std::chrono::steady_clock::now();
    LatLongImage picture = rig.picture(file);
    outside_ms += ms_since(asked);
    return picture;
  });
  verify_bug(lamp.ok(), "bench: a simulated rig is refused");
  Row row = row_of_one_run("build", "17x17 pictures of 180x180", ms_since(begin) - outside_ms);
  built = *std::move(lamp);
  const double pictures = static_cast<double>(rig.rig.pictures.size());
  row.values = {{"pictures", pictures}, {"ms_a_picture", row.timing.p50_ms / pictures}};
  return row;
}

// Time: of one surface element.
std::vector<Row> form_rows(const test::AnalyticLamp& truth, const calibration::BuiltLamp& built,
                           const Options& options) {
  const Luminaire& lamp = built.lamp;
  const FarField far = far_field_of(lamp);
  using Form = std::pair<std::string, std::function<Rgbd(const Vec3d&, const Vec3d&)>>;
  const std::vector<Form> forms = {
      {"near field", [&](const Vec3d& p, const Vec3d& n) { return illuminance(lamp, p, n); }},
      {"exact (2003)",
       [&](const Vec3d& p, const Vec3d& n) { return illuminance(built.measured, LampForm::exact, p, n); }},
      {"shift-invariant (2003)",
       [&](const Vec3d& p, const Vec3d& n) {
         return illuminance(built.measured, LampForm::shift_invariant, p, n);
       }},
      // Grey, as files of far fields are: errors are those of luminance.
      {"far field",
       [&](const Vec3d& p, const Vec3d& n) { return Rgbd(Rgbd::Constant(illuminance(far, p, n))); }}};
  Options shorter = options;
  shorter.seconds_per_case = 0.1 * options.seconds_per_case;
  std::vector<Row> rows;
  for (const double distance : {0.1, 0.2, 0.4, 0.7, 1.0, 2.0, 4.0, 10.0}) {
    std::vector<Case> cases;
    for (const Form& form : forms) {
      const auto grey = [](const Rgbd& lux) { return Rgbd(Rgbd::Constant(luminance(lux))); };
      double error = 0, norm = 0;
      for (const auto& [x, y] :
           {std::pair(0.0, 0.0), std::pair(0.13, 0.22), std::pair(0.31, 0.0), std::pair(0.5, -0.22)}) {
        const Vec3d point = Vec3d(x, y, -distance) * truth.distance_m;
        const Rgbd exact = grey(truth.illuminance(point, Vec3d::UnitZ()));
        error += (grey(form.second(point, Vec3d::UnitZ())) - exact).square().sum();
        norm += exact.square().sum();
      }
      cases.push_back({form.first,
                       [&, distance](std::size_t i) {
                         const Vec3d at =
                             Vec3d(0.1 * static_cast<double>(i % 5), 0, -distance) * truth.distance_m;
                         volatile double lux = form.second(at, Vec3d::UnitZ())[1];
                         (void)lux;
                       },
                       {{"distance", distance}, {"rel_rms_error", std::sqrt(error / norm)}}});
    }
    for (Row& row : time_in_turns(kForms, std::move(cases), shorter, "", {1, 5})) {
      char name[40];
      std::snprintf(name, sizeof name, " at %g d", distance);
      row.name += name;
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

// A LED of the reference data where it is there, else a Lambertian square of 4 cm: 100,000 rays either way.
std::vector<LampRay> rays_of(const Options& options, std::string& name) {
  const auto file =
      std::filesystem::path(options.data_folder) / "luminaires" / "rayfile_LERTDUW_S2WP_blue_100k.TM25RAY";
  if (!options.data_folder.empty() && std::filesystem::exists(file)) {
    const auto read = read_tm25(file);
    verify_bug(read.ok(), "bench: a ray file of the reference data is refused");
    name = "LED, 100,000 rays";
    return read->rays;
  }
  name = "Lambertian square, 100,000 rays";
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<LampRay> rays;
  for (int i = 0; i < 100000; ++i) {
    const double sine = std::sqrt(unit(random)), turn = 2 * kPi * unit(random);
    rays.push_back({Vec3d(0.04 * unit(random) - 0.02, 0.04 * unit(random) - 0.02, 0),
                    Vec3d(sine * std::cos(turn), sine * std::sin(turn), -std::sqrt(1 - sine * sine)), 1e-3});
  }
  return rays;
}

struct PlaneError {
  double error = 0,
         noise = 0;  // relative RMSE against the rays in 10² squares; what of it is the rays' own noise
};
PlaneError plane_error(const std::vector<LampRay>& rays, const Luminaire& lamp, double distance) {
  constexpr int kBins = 10, kPoints = 4;
  const double bin = 2 * distance / kBins;
  std::vector<double> lux(kBins * kBins), variance(kBins * kBins);
  for (const LampRay& ray : rays) {
    if (!(ray.direction.z() < 0)) continue;
    const Vec3d at = ray.origin_m + ray.direction * ((-distance - ray.origin_m.z()) / ray.direction.z());
    const double x = std::floor((at.x() + distance) / bin), y = std::floor((at.y() + distance) / bin);
    if (!(x >= 0 && y >= 0 && x < kBins && y < kBins)) continue;
    const auto i = static_cast<std::size_t>(y * kBins + x);
    const double share = ray.flux_lm / (bin * bin);
    lux[i] += share;
    variance[i] += share * share;
  }
  PlaneError out;
  double norm = 0;
  for (int i = 0; i < kBins * kBins; ++i) {
    double mean = 0;
    for (int k = 0; k < kPoints * kPoints; ++k)
      mean += illuminance(lamp,
                          Vec3d((i % kBins + (k % kPoints + 0.5) / kPoints) * bin - distance,
                                (i / kBins + (k / kPoints + 0.5) / kPoints) * bin - distance, -distance),
                          Vec3d::UnitZ())[1] /
              (kPoints * kPoints);
    const auto at = static_cast<std::size_t>(i);
    out.error += (mean - lux[at]) * (mean - lux[at]);
    out.noise += variance[at];
    norm += lux[at] * lux[at];
  }
  return {std::sqrt(out.error / norm), std::sqrt(out.noise / norm)};
}

std::string text_of(const std::vector<LampRay>& rays) {
  std::string text = "x,y,z,u,v,w,flux\n";
  char line[200];
  for (const LampRay& r : rays) {
    std::snprintf(line, sizeof line, "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", r.origin_m.x(), r.origin_m.y(),
                  r.origin_m.z(), r.direction.x(), r.direction.y(), r.direction.z(), r.flux_lm);
    text += line;
  }
  return text;
}

std::vector<Row> ray_rows(const Options& options) {
  std::string name;
  const std::vector<LampRay> rays = rays_of(options, name);
  const std::string text = text_of(rays);
  const auto rate = [&](Row row) {
    row.values.emplace_back("rays_per_s", static_cast<double>(rays.size()) / row.timing.p50_ms * 1e3);
    return row;
  };
  std::vector<Row> rows;
  std::vector<Case> cases = {
      {"text read",
       [&](std::size_t) { verify_bug(parse_plain_rays(text, "").ok(), "bench: rays are refused"); },
       {}},
      {"binned to 8x8 sources", [&](std::size_t) { (void)bin_rays(rays, {}); }, {}}};
  for (Row& row : time_in_turns("import, " + name, std::move(cases), options, "", {1, 5}))
    rows.push_back(rate(std::move(row)));
  for (const int positions : {2, 4, 8, 16}) {
    const Luminaire lamp = bin_rays(rays, {positions, 0});
    for (const double distance : {0.1, 0.3, 1.0}) {
      const auto begin = std::chrono::steady_clock::now();
      const PlaneError error = plane_error(rays, lamp, distance);
      char what[60];
      std::snprintf(what, sizeof what, "%dx%d sources at %g m", positions, positions, distance);
      rows.push_back(row_of_one_run(kRays, what, ms_since(begin) / 1600));
      rows.back().values = {{"positions", static_cast<double>(positions)},
                            {"distance_m", distance},
                            {"rel_rms_error", error.error},
                            {"of_it_noise_of_rays", error.noise}};
    }
  }
  return rows;
}

double value_of(const Row& row, const std::string& key) {
  for (const auto& [name, value] : row.values)
    if (name == key) return value;
  return std::numeric_limits<double>::quiet_NaN();
}

// One line a name before " at ", y "ms": the time.
std::vector<Line> lines_of(const std::vector<Row>& rows, const std::string& x, const std::string& y,
                           bool points_only = false) {
  std::vector<Line> lines;
  for (const Row& row : rows) {
    if (row.setting != kForms) continue;
    const std::string name = row.name.substr(0, row.name.find(" at "));
    auto line = std::find_if(lines.begin(), lines.end(), [&](const Line& l) { return l.name == name; });
    if (line == lines.end()) line = lines.insert(lines.end(), {name, {}, points_only});
    const auto measure = [&](const std::string& key) {
      return key == "ms" ? row.timing.p50_ms : value_of(row, key);
    };
    line->points.emplace_back(measure(x), measure(y));
  }
  return lines;
}

std::vector<Line> ray_lines(const std::vector<Row>& rows) {
  std::vector<Line> lines;
  for (const Row& row : rows) {
    if (row.setting != kRays) continue;
    const std::string name = "rays, " + row.name.substr(0, row.name.find(" sources")) + " sources";
    if (lines.empty() || lines.back().name != name) lines.push_back({name, {}});
    lines.back().points.emplace_back(value_of(row, "distance_m"), value_of(row, "rel_rms_error"));
  }
  Line noise{"the rays' own noise", {}};
  for (const Row& row : rows)
    if (row.setting == kRays && value_of(row, "positions") == 8)
      noise.points.emplace_back(value_of(row, "distance_m"), value_of(row, "of_it_noise_of_rays"));
  lines.push_back(std::move(noise));
  return lines;
}

}  // namespace

std::vector<Row> luminaire_suite(const Options& options) {
  test::SimulatedRig rig = test::simulated_rig(test::reflector_lamp(), 17, 180);
  calibration::BuiltLamp built;
  std::vector<Row> rows = {build_row(rig, built)};
  for (Row& row : form_rows(rig.lamp, built, options)) rows.push_back(std::move(row));
  for (Row& row : ray_rows(options)) rows.push_back(std::move(row));
  for (Row& row : lamp_location_rows(options)) rows.push_back(std::move(row));
  return rows;
}

std::vector<Figure> luminaire_figures(const std::vector<Row>& rows) {
  const std::vector<double> distances = {0.1, 0.2, 0.4, 1, 2, 4, 10};
  const std::string distance = "distance, in distances of the planes", error = "relative RMSE";
  return {{"luminaire", to_svg({{"Error against distance", distance, error, true, true,
                                 lines_of(rows, "distance", "rel_rms_error"), distances},
                                {"Time against distance", distance, "ms a surface element, median", true,
                                 true, lines_of(rows, "distance", "ms"), distances},
                                {"Error against time", "ms a surface element, median", error, true, true,
                                 lines_of(rows, "ms", "rel_rms_error", true)},
                                {"Imported rays against their own squares",
                                 "distance, m",
                                 error,
                                 true,
                                 false,
                                 ray_lines(rows),
                                 {0.1, 0.3, 1}}},
                               "lightwell bench --suite luminaire: reflector with filament, 17x17 positions "
                               "a tenth of the planes' distance apart")},
          {"lamp-location", to_svg({lamp_location_chart(rows)},
                                   "lightwell bench --suite luminaire: 1000 lamps at each distance")}};
}

}  // namespace lightwell::bench
