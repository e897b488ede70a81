// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>

#include "bench/ceres_lights.h"
#include "bench/chart.h"
#include "bench/madsen_newton.h"
#include "bench/painting.h"
#include "bench/suite.h"
#include "interface/environment_io.h"
#include "lighting/fit/few_lights.h"
#include "lighting/fit/light_search.h"
#include "lighting/lat_long_image.h"

namespace lightwell::bench {
namespace {

const PolarGrid kGrid{180, 360, kPi};
constexpr int kMostFewest = 8;  // up to so many lights the best of random starts is known
constexpr int kStarts = 200;
const std::string kResidualAgainstLights = "residual against lights, ";

// A whole sphere of light, its probe, and the best residual that 200 random starts reach with so many lights.
struct Scene {
  PolarMap map;
  ProbeIrradiance probe;
  std::map<int, double> best;
};

bool is_capture(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  const bool image = file.extension() == ".hdr" || file.extension() == ".exr";
  // Charts, cube maps and a synthetic pixel are not captures.
  return image && !name.starts_with("Orientation") && name.find("Cube") == std::string::npos &&
         !name.starts_with("spot1Lux");
}

std::vector<PolarMap> maps_of(const Options& options) {
  std::vector<PolarMap> maps;
  const auto folder = std::filesystem::path(options.data_folder) / "env";
  if (!options.data_folder.empty() && std::filesystem::is_directory(folder)) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      if (is_capture(entry.path())) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const auto& file : files)
      if (const auto environment = read_environment(file))
        maps.push_back(resample_polar(polar_map_from_lat_long(environment->image, false), kGrid));
  }
  if (!maps.empty()) return maps;
  for (int i = 0; i < 8; ++i) {
    PolarMap map = PolarMap::make(kGrid, 3);
    if (i % 2 == 0) {
      paint(map, room_radiance);
    } else {
      paint(map, [](const Vec3d& d) -> Rgb { return sky_radiance(d) * (d.y() > 0 ? 1.0f : 0.1f); });
      add_disc(map, from_degrees(20 + 8 * i, 40 * i), 1, Rgb(8e4f, 7e4f, 6e4f));
    }
    add_disc(map, from_degrees(60, 50 * i), 4, Rgb(900, 700, 300) * static_cast<float>(1 + i));
    maps.push_back(std::move(map));
  }
  return maps;
}

std::vector<Scene> scenes_of(const Options& options) {
  std::vector<Scene> scenes;
  LambertianProbe probe(kGrid);
  for (PolarMap& map : maps_of(options)) {
    Scene scene{std::move(map), {}, {}};
    probe.irradiance(scene.map, scene.probe);
    FaceObservations faces(false);
    faces.set_probe(scene.probe);
    LightSearch search(faces, 1e-6);
    for (int lights = 1; lights <= kMostFewest; ++lights) {
      double best = std::numeric_limits<double>::infinity();
      std::uint64_t state = static_cast<std::uint64_t>(lights);
      for (int start = 0; start < kStarts; ++start) {
        LightsTrial trial = random_directions(lights, state);
        search.refine(trial, 60);
        best = std::min(best, std::sqrt(trial.cost));
      }
      scene.best[lights] = best;
    }
    scenes.push_back(std::move(scene));
  }
  return scenes;
}

// Residuals of a method over the scenes.
class Residuals {
 public:
  void add(double residual, double best, bool negative) {
    log_sum_ += std::log(std::max(residual, 1e-12));
    const double ratio = residual / best;
    worst_ = std::max(worst_, ratio);
    within_ += ratio <= 1.02 ? 1 : 0;
    negative_ += negative ? 1 : 0;
    ++count_;
  }
  [[nodiscard]] std::vector<std::pair<std::string, double>> values() const {
    const double n = count_;
    return {{"residual", std::exp(log_sum_ / n)},
            {"within_2_percent_of_best_of_200_starts", within_ / n},
            {"worst_over_best", worst_},
            {"negative_radiance", negative_ / n}};
  }

 private:
  double log_sum_ = 0, worst_ = 0, within_ = 0, negative_ = 0;
  int count_ = 0;
};

FewLights fitter_for(int lights) {
  FewLightsOptions options;
  options.lights = lights;
  return FewLights::create(kGrid, options).value();
}

LightsTrial spread_start(int lights) {
  LightsTrial trial;
  for (int k = 0; k < lights; ++k)
    trial.add(
        direction_from_spherical({std::acos(1 - (2 * k + 1.0) / lights), k * kPi * (3 - std::sqrt(5.0))}));
  return trial;
}

struct Method {
  std::string name;
  std::function<std::pair<double, bool>(const Scene&)> fit;  // residual, whether a radiance is negative
};

std::vector<Method> methods(int lights) {
  const auto cold = std::make_shared<FewLights>(fitter_for(lights));
  const auto warm = std::make_shared<FewLights>(fitter_for(lights));
  return {
      {"Lightwell, cold",
       [cold](const Scene& scene) {
         cold->reset();
         return std::pair{cold->fit(scene.map).residual, false};
       }},
      // The same scene was the frame before.
      {"Lightwell, warm",
       [warm](const Scene& scene) {
         return std::pair{warm->fit(scene.map).residual, false};
       }},
      {"as printed (Newton, 20 steps)",
       [lights](const Scene& scene) {
         const MadsenFit fit = madsen_newton(scene.probe, lights);
         return std::pair{fit.residual, fit.negative()};
       }},
      {"Ceres, spread start",
       [lights](const Scene& scene) {
         return std::pair{ceres_fit(scene.probe, spread_start(lights)), false};
       }},
  };
}

// Times of one number of lights, a scene after the other; warm fits see each scene three times.
std::vector<Row> times(const std::vector<Scene>& scenes, int lights, const Options& options) {
  std::vector<Case> cases;
  for (const Method& method : methods(lights)) {
    Residuals residuals;
    const bool warm = method.name == "Lightwell, warm";
    for (const Scene& scene : scenes) {
      if (warm) method.fit(scene);
      const auto [residual, negative] = method.fit(scene);
      residuals.add(residual, scene.best.at(lights), negative);
    }
    cases.push_back({method.name,
                     [&scenes, method](std::size_t i) { method.fit(scenes[i / 6 % scenes.size()]); },
                     residuals.values()});
  }
  // Six in a row are of one scene: the first of them warms up.
  return time_in_turns("time and residual, " + std::to_string(lights) + " lights", cases, options,
                       cases.front().name, {.in_a_row = 5, .least_runs = 5 * scenes.size()});
}

Row without_time(const std::string& setting, const std::string& name,
                 std::vector<std::pair<std::string, double>> values) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  return {setting, name, {kNone, kNone, kNone, 0}, std::move(values)};
}

std::vector<Row> residual_by_number(const std::vector<Scene>& scenes) {
  std::vector<Row> rows;
  for (int lights = 1; lights <= kMostFewest; ++lights)
    for (const Method& method : methods(lights)) {
      if (method.name == "Lightwell, warm") continue;
      Residuals residuals;
      for (const Scene& scene : scenes) {
        const auto [residual, negative] = method.fit(scene);
        residuals.add(residual, scene.best.at(lights), negative);
      }
      rows.push_back(
          without_time(kResidualAgainstLights + std::to_string(lights), method.name, residuals.values()));
    }
  return rows;
}

// How often --max-error finds the fewest lights that any of 200 starts reaches.
std::vector<Row> fewest(const std::vector<Scene>& scenes) {
  std::vector<Row> rows;
  for (const double bound : {0.1, 0.05, 0.03, 0.02}) {
    double cases = 0, right = 0, lights = 0;
    FewLightsOptions options;
    options.lights = kMostFittedLights;
    options.max_error = bound;
    FewLights fitter = FewLights::create(kGrid, options).value();
    for (const Scene& scene : scenes) {
      int least = 0;
      for (int m = kMostFewest; m >= 1; --m)
        if (scene.best.at(m) <= bound) least = m;
      if (least == 0) continue;  // more than is known
      fitter.reset();
      const int count = fitter.fit(scene.map).count;
      cases += 1;
      lights += count;
      right += count <= least ? 1 : 0;
    }
    if (cases == 0) continue;
    rows.push_back(without_time(
        "fewest lights for an error", "bound " + std::to_string(bound).substr(0, 4),
        {{"cases", cases}, {"as_few_as_any_of_200_starts", right / cases}, {"mean_lights", lights / cases}}));
  }
  return rows;
}

}  // namespace

std::vector<Row> fit_suite(const Options& options) {
  const std::vector<Scene> scenes = scenes_of(options);
  std::vector<Row> rows;
  const auto append = [&](std::vector<Row> more) {
    rows.insert(rows.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  };
  for (const int lights : {1, 4, 8}) append(times(scenes, lights, options));
  append(residual_by_number(scenes));
  append(fewest(scenes));
  return rows;
}

namespace {

// A value of the rows against the number of lights, every method a line.
Chart against_lights(const std::vector<Row>& rows, const std::string& value, const std::string& title,
                     const std::string& label, bool log_y) {
  Chart chart{title, "lights", label, false, log_y, {}};
  for (const Row& row : rows) {
    if (!row.setting.starts_with(kResidualAgainstLights)) continue;
    const double lights = std::stod(row.setting.substr(kResidualAgainstLights.size()));
    auto line = std::find_if(chart.lines.begin(), chart.lines.end(),
                             [&](const Line& l) { return l.name == row.name; });
    if (line == chart.lines.end()) line = chart.lines.insert(line, Line{row.name, {}});
    for (const auto& [key, number] : row.values)
      if (key == value) line->points.emplace_back(lights, number);
  }
  for (int lights = 1; lights <= kMostFewest; ++lights) chart.x_ticks.push_back(lights);
  return chart;
}

}  // namespace

std::vector<Figure> fit_figures(const std::vector<Row>& rows) {
  return {{"fit", to_svg({against_lights(rows, "residual", "Residual", "relative RMSE of the probe", true),
                          against_lights(rows, "negative_radiance", "Fits with negative radiance",
                                         "part of all maps", false)},
                         "Ambient and M directional lights on a white sphere; lightwell bench --suite fit")}};
}

}  // namespace lightwell::bench
