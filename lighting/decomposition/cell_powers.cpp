// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/cell_powers.h"

#include <algorithm>

#include "lighting/decomposition/lit_bins.h"
#include "lighting/decomposition/voronoi_cells.h"

namespace lightwell {
namespace {

std::vector<Rgbd> powers_of(const PolarMap& map, const LitBins& bins, const VoronoiCells& cells) {
  std::vector<Rgbd> power(cells.places().size(), Rgbd::Zero());
  for (std::size_t i = 0; i < bins.size(); ++i) power[cells.cell(i)] += bin_illuminance(map, bins.bin[i]);
  return power;
}

std::vector<Vec3d> places_of(std::span<const DirectionalLight> lights) {
  std::vector<Vec3d> places;
  for (const DirectionalLight& light : lights)
    places.emplace_back(light.direction.cast<double>().normalized());
  return places;
}

}  // namespace

void set_cell_powers(const PolarMap& map, std::span<DirectionalLight> lights) {
  const LitBins bins = lit_bins(map);
  VoronoiCells cells(bins);
  cells.assign(places_of(lights));
  const std::vector<Rgbd> power = powers_of(map, bins, cells);
  for (std::size_t i = 0; i < lights.size(); ++i) lights[i].illuminance = power[i].cast<float>();
}

void set_cell_means(const PolarMap& map, std::span<DirectionalLight> lights) {
  const LitBins bins = lit_bins(map);
  VoronoiCells cells(bins);
  cells.assign(places_of(lights));
  const std::vector<DirectionalLight> at_means = lights_at_means(map, bins, cells);
  for (std::size_t i = 0; i < lights.size(); ++i) {
    lights[i].direction = at_means[i].direction;
    lights[i].illuminance = at_means[i].illuminance;
  }
}

std::vector<DirectionalLight> lights_at_means(const PolarMap& map, const LitBins& bins,
                                              const VoronoiCells& cells) {
  const std::vector<Rgbd> power = powers_of(map, bins, cells);
  std::vector<Vec3d> moment(power.size(), Vec3d::Zero());
  for (std::size_t i = 0; i < bins.size(); ++i) moment[cells.cell(i)] += bins.power[i] * bins.direction[i];
  std::vector<DirectionalLight> lights(power.size());
  for (std::size_t p = 0; p < lights.size(); ++p) {
    // Opposite halves of a cell have no mean direction.
    const Vec3d mean = moment[p].norm() > 0 ? Vec3d(moment[p].normalized()) : cells.places()[p];
    lights[p].direction = mean.cast<float>();
    lights[p].illuminance = power[p].cast<float>();
  }
  return lights;
}

std::vector<DirectionalLight> lights_of_cells(const PolarMap& map, const LitBins& bins,
                                              std::span<const Vec3d> places, std::size_t count) {
  VoronoiCells cells(bins);
  cells.assign(places);
  const std::vector<Rgbd> power = powers_of(map, bins, cells);
  std::vector<DirectionalLight> lights(count);
  for (std::size_t i = 0; i < count; ++i) {
    const bool dark = i >= places.size();
    lights[i].direction = places[dark ? 0 : i].cast<float>();
    lights[i].illuminance = dark ? Rgb(Rgb::Zero()) : Rgb(power[i].cast<float>());
  }
  return lights;
}

void set_equal_powers(const PolarMap& map, std::span<DirectionalLight> lights) {
  constexpr double kLargestScale = 4;
  const Rgbd total = total_illuminance(map);
  const auto count = static_cast<double>(lights.size());
  const double share = luminance(total) / count;
  if (!(share > 0)) return;  // a black map: no light has power
  std::vector<Rgbd> power;
  Rgbd sum = Rgbd::Zero();
  for (const DirectionalLight& light : lights) {
    const Rgbd own = light.illuminance.cast<double>();
    const double y = luminance(own);
    power.emplace_back(y > 0 ? Rgbd(own * (share / y)) : Rgbd(total / count));
    sum += power.back();
  }
  for (int c = 0; c < 3; ++c) {
    const double scale = sum[c] > 0 ? std::min(total[c] / sum[c], kLargestScale) : 0;
    const double rest = std::max(0.0, total[c] - sum[c] * scale) / count;
    for (std::size_t i = 0; i < lights.size(); ++i)
      lights[i].illuminance[c] = static_cast<float>(power[i][c] * scale + rest);
  }
}

}  // namespace lightwell
