// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/lamp_location_rows.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <random>
#include <string>

#include "lighting/field/lamp_location.h"
#include "lighting/result.h"

namespace lightwell::bench {
namespace {

constexpr double kSigma_rad = 0.2 * kPi / 180;
constexpr std::size_t kLamps = 1000;
constexpr std::array kDistances_m = {1.0, 2.0, 3.0, 5.0, 10.0, 30.0};
constexpr const char* kOurs = "inverse distance";
constexpr const char* kMiddle = "middle of the rays";

struct Sight {
  Vec3d lamp;
  std::vector<SightRay> rays;
};

// All within a metre.
const std::vector<Vec3d> kTwo = {{-0.5, 0, 0}, {0.5, 0, 0}};
const std::vector<Vec3d> kFive = {{-0.5, 0, 0}, {0.5, 0, 0}, {0, 0, 0.5}, {0, 0.3, -0.5}, {0.2, 0.1, 0}};

// Lamps in all directions of the upper half.
std::vector<Sight> sights_at(double distance_m, const std::vector<Vec3d>& probes) {
  std::mt19937 random(17);
  std::normal_distribution<double> error(0, kSigma_rad);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Sight> sights;
  while (sights.size() < kLamps) {
    const double up = unit(random), turn = 2 * kPi * unit(random), sine = std::sqrt(1 - up * up);
    const Vec3d direction(sine * std::cos(turn), up, sine * std::sin(turn));
    if (std::abs(direction.x()) > 0.7) continue;  // along two probes' line nothing can be told
    Sight sight{distance_m * direction, {}};
    for (const Vec3d& from : probes) {
      const Vec3d toward = (sight.lamp - from).normalized(), across = toward.unitOrthogonal();
      const double a = error(random), b = error(random);
      sight.rays.push_back({from, (toward + a * across + b * toward.cross(across)).normalized()});
    }
    sights.push_back(std::move(sight));
  }
  return sights;
}

// The mean over pairs of rays that pass each other ahead.
std::optional<Vec3d> middle_of(const std::vector<SightRay>& rays) {
  Vec3d sum = Vec3d::Zero();
  int pairs = 0;
  for (std::size_t i = 0; i < rays.size(); ++i)
    for (std::size_t j = i + 1; j < rays.size(); ++j)
      if (const auto met = meeting_point(rays[i], rays[j], 0.01)) {
        sum += *met;
        ++pairs;
      }
  return pairs > 0 ? std::optional<Vec3d>(sum / pairs) : std::nullopt;
}

using Values = std::vector<std::pair<std::string, double>>;

// Of those that have a place: relative error, RMS; how many they are; how many claims of 95 % hold, of all.
Values values_of_ours(const std::vector<Sight>& sights, double distance_m) {
  double squares = 0, placed = 0, held = 0;
  for (const Sight& sight : sights) {
    const auto found = locate_lamp(sight.rays, kSigma_rad);
    if (!found) continue;
    const auto [near_m, far_m] = found->distance();
    const double truth = (sight.lamp - sight.rays.front().origin).norm();
    held += near_m <= truth && truth <= far_m ? 1 : 0;
    if (!found->is_near()) continue;
    ++placed;
    squares += (found->position - sight.lamp).squaredNorm();
  }
  return {{"rel_rms_error", placed > 0 ? std::sqrt(squares / placed) / distance_m : 0},
          {"distance_m", distance_m},
          {"placed", placed / kLamps},
          {"claims_right", held / kLamps}};
}

Values values_of_middle(const std::vector<Sight>& sights, double distance_m) {
  double squares = 0, placed = 0;
  for (const Sight& sight : sights) {
    const auto met = middle_of(sight.rays);
    if (!met) continue;
    ++placed;
    squares += (*met - sight.lamp).squaredNorm();
  }
  return {{"rel_rms_error", placed > 0 ? std::sqrt(squares / placed) / distance_m : 0},
          {"distance_m", distance_m},
          {"placed", placed / kLamps}};
}

}  // namespace

std::vector<Row> lamp_location_rows(const Options& options) {
  Options shorter = options;
  shorter.seconds_per_case = 0.1 * options.seconds_per_case;
  std::vector<Row> rows;
  for (const auto* probes : {&kTwo, &kFive})
    for (const double distance : kDistances_m) {
      const std::vector<Sight> sights = sights_at(distance, *probes);
      double sink = 0;  // what is not asked for is not computed
      std::vector<Case> cases = {{kOurs,
                                  [&](std::size_t) {
                                    for (const Sight& s : sights)
                                      sink += locate_lamp(s.rays, kSigma_rad)->direction.x();
                                  },
                                  values_of_ours(sights, distance)},
                                 {kMiddle,
                                  [&](std::size_t) {
                                    for (const Sight& s : sights)
                                      sink += middle_of(s.rays).value_or(Vec3d::Zero()).x();
                                  },
                                  values_of_middle(sights, distance)}};
      char setting[80];
      std::snprintf(setting, sizeof setting, "1000 lamps at %g m, %s probes", distance,
                    probes == &kTwo ? "two" : "five");
      for (Row& row : time_in_turns(setting, std::move(cases), shorter, kOurs, {1, 5})) {
        row.values.emplace_back("probes", static_cast<double>(probes->size()));
        rows.push_back(std::move(row));
      }
      verify_bug(std::isfinite(sink), "bench: lamps that are no number");
    }
  return rows;
}

Chart lamp_location_chart(const std::vector<Row>& rows) {
  std::vector<Line> lines;
  for (const char* probes : {"two probes", "five probes"})
    for (const char* method : {kOurs, kMiddle}) {
      Line line{std::string(method) + ", " + probes, {}};
      for (const Row& row : rows)
        if (row.name == method && row.setting.ends_with(probes) && row.values[2].second > 0)
          line.points.emplace_back(row.values[1].second, row.values[0].second);
      lines.push_back(std::move(line));
    }
  return {"Lamps located by probes within 1 m, .2° off",
          "distance, m",
          "relative RMSE of the place",
          true,
          true,
          lines,
          {kDistances_m.begin(), kDistances_m.end()}};
}

}  // namespace lightwell::bench
