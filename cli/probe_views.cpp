// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/probe_views.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "interface/environment_io.h"
#include "interface/light_set_io.h"
#include "lighting/field/polar_cells.h"
#include "lighting/field/sphere_partition.h"

namespace lightwell::cli {
namespace {

constexpr int kMostSectors = 720;  // half a degree: finer pictures tell no more of a lamp's middle
constexpr int kRounds = 6;         // each finds eight
constexpr std::size_t kMostLamps = 32;
constexpr int kCells = 384;  // what the finder's shares are of, which are not asked for here

// To the lowest row with light: below it a camera that looks up saw nothing.
double theta_max_of(const LatLongImage& image) {
  for (int y = image.height - 1; y >= 0; --y)
    for (int x = 0; x < image.width; ++x)
      if (image.at(x, y).maxCoeff() > 0) return kPi * (y + 1) / image.height;
  return kPi;
}

void find_lamps(const LatLongImage& image, std::vector<LampSighting>& lamps) {
  PolarMap map = polar_map_from_lat_long(image, false);
  if (map.grid.sectors > kMostSectors)
    map = resample_polar(map, {kMostSectors / 2, kMostSectors, map.grid.theta_max_rad});
  const PolarCells cells(map.grid, SpherePartition(kCells));
  LampFinder(cells).find(map, lamps);
}

LatLongImage without(LatLongImage image, const std::vector<LampSighting>& lamps,
                     const std::vector<int>& removed);

// A lamp beside the sun is nothing of the picture's light, but of what is left without the sun.
std::vector<LampSighting> lamps_of(LatLongImage image) {
  std::vector<LampSighting> lamps;
  for (int round = 0; round < kRounds && lamps.size() < kMostLamps; ++round) {
    std::vector<LampSighting> found;
    find_lamps(image, found);
    if (found.empty()) break;
    std::vector<int> all(found.size());
    std::iota(all.begin(), all.end(), 0);
    image = without(std::move(image), found, all);
    for (LampSighting& lamp : found)
      if (lamps.size() < kMostLamps) lamps.push_back(std::move(lamp));
  }
  return lamps;
}

LatLongImage without(LatLongImage image, const std::vector<LampSighting>& lamps,
                     const std::vector<int>& removed) {
  for (const int i : removed) {
    const LampSighting& lamp = lamps[static_cast<std::size_t>(i)];
    const double least = std::cos(lamp.reach_rad);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const Vec3d direction = direction_from_lat_long((x + 0.5) / image.width, (y + 0.5) / image.height);
        if (direction.dot(lamp.direction) >= least) image.at(x, y) = image.at(x, y).min(lamp.surroundings);
      }
  }
  return image;
}

LightSet without(const LightSet& set, const std::vector<LightSighting>& sightings,
                 const std::vector<int>& removed) {
  std::vector<bool> gone(set.lights.size(), false);
  for (const int i : removed)
    for (const std::size_t light : sightings[static_cast<std::size_t>(i)].lights) gone[light] = true;
  LightSet rest = set;
  rest.lights.clear();
  rest.has_parents = false;  // a tree with holes is none
  for (std::size_t i = 0; i < set.lights.size(); ++i) {
    if (gone[i]) {
      rest.total_illuminance = (rest.total_illuminance - set.lights[i].illuminance).max(0.0f);
      continue;
    }
    rest.lights.push_back(set.lights[i]);
    rest.lights.back().parent = -1;
    rest.lights.back().predicted_error = 0;
  }
  return rest;
}

}  // namespace

Result<ProbeView> read_probe_view(const std::filesystem::path& file) {
  ProbeView view;
  if (file.extension() == ".json") {
    auto set = read_light_set(file);
    if (!set) return set.error();
    view.theta_max_rad = set->coverage == Coverage::hemisphere ? kPi / 2 : kPi;
    view.sets = light_sightings(*set);
    for (const LightSighting& sighting : view.sets) view.lamps.push_back(sighting.lamp);
    view.content = *std::move(set);
    return view;
  }
  auto read = read_environment(file);
  if (!read) return read.error();
  view.remark = read->remark(file);
  view.theta_max_rad = theta_max_of(read->image);
  view.lamps = lamps_of(read->image);
  view.content = std::move(read->image);
  return view;
}

Status write_without(const ProbeView& view, const std::vector<int>& removed,
                     const std::filesystem::path& file) {
  if (const auto* image = std::get_if<LatLongImage>(&view.content))
    return write_environment(file, without(*image, view.lamps, removed));
  return write_light_set(file, without(std::get<LightSet>(view.content), view.sets, removed));
}

}  // namespace lightwell::cli
