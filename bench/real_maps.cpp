// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/real_maps.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "bench/painting.h"
#include "interface/environment_io.h"
#include "lighting/lat_long_image.h"

namespace lightwell::bench {
namespace {

const PolarGrid kGrid{90, 360, kPi / 2};

bool is_test_pattern(const std::string& name) {
  return std::ranges::any_of(std::array{"Orientation", "Cube", "spot1Lux"},
                             [&](const char* word) { return name.find(word) != std::string::npos; });
}

}  // namespace

std::vector<NamedMap> real_maps(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  if (std::filesystem::is_directory(folder))
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      if (const auto end = entry.path().extension(); end == ".hdr" || end == ".exr")
        if (!is_test_pattern(entry.path().filename().string())) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<NamedMap> maps;
  for (const std::filesystem::path& file : files) {
    const auto environment = read_environment(file);
    if (!environment) {
      std::fprintf(stderr, "left out: %s\n", environment.error().message.c_str());
      continue;
    }
    maps.push_back(
        {file.stem().string(), resample_polar(polar_map_from_lat_long(environment->image, true), kGrid)});
  }
  return maps;
}

std::vector<NamedMap> painted_maps() {
  PolarMap sky = PolarMap::make(kGrid, 3);
  paint(sky, sky_radiance);
  PolarMap sunny = sky;
  add_disc(sunny, from_degrees(48, 100), 0.6, Rgb(5400, 5000, 4200));
  PolarMap room = PolarMap::make(kGrid, 3);
  paint(room, room_radiance);
  PolarMap lamps = room;
  for (float& value : lamps.radiance) value *= 0.02f;
  for (int i = 0; i < 40; ++i)
    add_disc(lamps, from_degrees(10 + 37 * i % 78, 97.0 * i), 0.6 + 0.1 * (i % 7),
             Rgb(8.0f + static_cast<float>(i % 5), 9, 6));
  return {{"sky", std::move(sky)},
          {"sky and sun", std::move(sunny)},
          {"room", std::move(room)},
          {"night with lamps", std::move(lamps)}};
}

}  // namespace lightwell::bench
