// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>
#include <thread>

#include "bench/chart.h"
#include "bench/field_rows.h"
#include "bench/temporary_folder.h"
#include "tests/support/analytic_fields.h"

namespace lightwell::bench {
namespace {

// A line of /proc/self/status, kB.
double status_kb(const char* name) {
  std::ifstream file("/proc/self/status");
  std::string line;
  while (std::getline(file, line))
    if (line.starts_with(name)) return std::strtod(line.c_str() + std::strlen(name), nullptr);
  return 0;
}

struct Measured {
  double ms = 0, peak_mb = 0, directions = 0;
};

// In a process of its own: the peak is above what it was forked with.
Measured in_a_child(const ProbeTake& take, FieldBuildOptions options) {
  int ends[2];
  verify_bug(::pipe(ends) == 0, "bench: no pipe");
  const pid_t child = ::fork();
  verify_bug(child >= 0, "bench: no process");
  if (child == 0) {
    std::ofstream("/proc/self/clear_refs") << "5";  // proc(5): forgets the peak so far
    const double before_kb = status_kb("VmRSS:");
    const TemporaryFolder folder;
    options.scratch_folder = folder.path();
    const auto begin = std::chrono::steady_clock::now();
    Measured measured;
    {
      const auto build = build_field(take, options);
      verify_bug(build.ok(), "bench: a build refused");
      measured.directions = build->directions;
    }
    measured.ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    measured.peak_mb = (status_kb("VmHWM:") - before_kb) / 1e3;
    std::filesystem::remove_all(folder.path());
    ::_exit(::write(ends[1], &measured, sizeof measured) == sizeof measured ? 0 : 1);
  }
  Measured measured;
  ::close(ends[1]);
  verify_bug(::read(ends[0], &measured, sizeof measured) == sizeof measured,
             "bench: a build has ended early");
  ::close(ends[0]);
  ::waitpid(child, nullptr, 0);
  return measured;
}

Row build_row(const std::string& setting, std::size_t probes, int side, int directions,
              const ProbeProjection& projection, int width, int height) {
  FieldBuildOptions options;
  options.grid = unit_cube(side);
  options.projection = projection;
  options.directions = directions;
  options.threads = std::max(1u, std::thread::hardware_concurrency());
  const Measured measured = in_a_child(even_take(probes, width, height), options);
  Row row = row_of_one_run(setting, std::to_string(probes) + " probes, " + std::to_string(side) + " cubed",
                           measured.ms);
  row.values = {{"probes", static_cast<double>(probes)},
                {"points", static_cast<double>(options.grid.points())},
                {"directions", measured.directions},
                {"threads", options.threads},
                {"peak_mb", measured.peak_mb},
                {"samples_mb", static_cast<double>(probes) * measured.directions * sizeof(Rgb) / 1e6}};
  return row;
}

double value_of(const Row& row, const std::string& key) {
  for (const auto& [name, value] : row.values)
    if (name == key) return value;
  return std::numeric_limits<double>::quiet_NaN();
}

Line line_of(const std::vector<Row>& rows, const std::string& setting, const std::string& name,
             const std::string& x, const std::string& y) {
  Line line{name, {}};
  for (const Row& row : rows)
    if (row.setting == setting)
      line.points.emplace_back(value_of(row, x), y == "s" ? row.timing.p50_ms / 1e3 : value_of(row, y));
  return line;
}

// The first point's value times x.
Line straight(Line line) {
  const auto [x0, y0] = line.points.empty() ? std::pair(1.0, 1.0) : line.points.front();
  for (auto& [x, y] : line.points) y = y0 * x / x0;
  line.name = "linear";
  return line;
}

constexpr const char* kWithProbes = "growth with probes";
constexpr const char* kWithPoints = "growth with points";
constexpr const char* kSize = "size against error, box of two lamps, 32 cubed";

}  // namespace

FieldGrid unit_cube(int side) {
  return {{side, side, side}, Vec3d::Zero(), Vec3d::Ones()};
}

Row row_of_one_run(const std::string& setting, const std::string& name, double ms) {
  return {setting, name, {std::numeric_limits<double>::quiet_NaN(), ms, ms, 1}, {}};
}

ProbeTake even_take(std::size_t probes, int width, int height) {
  ProbeTake take;
  take.positions = test::random_positions(probes, 1);
  take.picture = [positions = take.positions, width, height](std::size_t i) -> Result<LatLongImage> {
    const auto light = static_cast<float>(1 + positions[i].x());
    return LatLongImage{
        width, height,
        std::vector<Rgb>(static_cast<std::size_t>(width * height), Rgb(light, 1, 0.5f * light))};
  };
  take.name = [](std::size_t i) { return std::to_string(i); };
  return take;
}

std::vector<Row> field_growth_rows(const Options& options) {
  std::vector<Row> rows;
  for (const std::size_t probes : {500u, 1000u, 2000u, 4000u})
    rows.push_back(build_row(kWithProbes, probes, 24, 3072, LatLongProbe{}, 64, 32));
  for (const int side : {16, 24, 32, 48})
    rows.push_back(build_row(kWithPoints, 500, side, 3072, LatLongProbe{}, 64, 32));
  // The paper's shape takes minutes on a slow machine: asked for with --seconds 10 or more.
  if (options.seconds_per_case >= 10)
    rows.push_back(build_row("shape of 2009's first scene, 250x250", 4397, 64, 0,
                             MirrorBallProbe{0.05, std::nullopt, 2.1 * kPi / 180}, 250, 250));
  return rows;
}

std::vector<Figure> field_figures(const std::vector<Row>& rows) {
  std::vector<Row> bars;
  for (const Row& row : rows)
    if (!row.setting.starts_with("growth") && row.setting != kSize) bars.push_back(row);
  const Line probes = line_of(rows, kWithProbes, "measured", "probes", "s");
  const Line points = line_of(rows, kWithPoints, "measured", "points", "s");
  return {
      {"field", to_svg("field", bars)},
      {"field-growth",
       to_svg({{"Time against probes, 24 cubed", "probes", "time, s", true, true, {probes, straight(probes)}},
               {"Time against grid points, 500 probes",
                "points",
                "time, s",
                true,
                true,
                {points, straight(points)}},
               {"Peak memory against the take's length, 24 cubed",
                "probes",
                "MB above the start",
                true,
                true,
                {line_of(rows, kWithProbes, "measured", "probes", "peak_mb"),
                 line_of(rows, kWithProbes, "samples on disk", "probes", "samples_mb")}},
               {"A file's size against its error",
                "rms error of what is read, relative",
                "MB",
                true,
                true,
                {line_of(rows, kSize, "measured", "rms_error", "megabytes")}}},
              "lightwell bench --suite field: degree 4, 3072 directions, all cores")}};
}

}  // namespace lightwell::bench
