// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/angular_radius.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lighting/decomposition/lit_bins.h"
#include "lighting/decomposition/voronoi_cells.h"
#include "lighting/second_moment.h"

namespace lightwell {

void set_angular_radii(const PolarMap& map, std::span<DirectionalLight> lights) {
  const LitBins bins = lit_bins(map);
  VoronoiCells cells(bins);
  // A light without power stands for nothing.
  std::vector<Vec3d> places;
  std::vector<std::size_t> light_of;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    lights[i].angular_radius_rad = 0;
    if (!(lights[i].illuminance.maxCoeff() > 0)) continue;
    places.emplace_back(lights[i].direction.cast<double>().normalized());
    light_of.push_back(i);
  }
  if (places.empty()) return;
  cells.assign(places);
  std::vector<SecondMoment> moments(places.size());
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const double distance = std::sqrt(std::max(0.0, 2 - 2 * cells.cosine(i)));
    moments[cells.cell(i)].add(bins.power[i], static_cast<double>(map.solid_angle_sr[bins.bin[i]]), distance);
  }
  for (std::size_t k = 0; k < places.size(); ++k)
    lights[light_of[k]].angular_radius_rad = moments[k].disc_radius_rad();
}

}  // namespace lightwell
