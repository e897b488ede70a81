// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/python_peers.h"

#include <sys/wait.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bench/temporary_folder.h"
#include "lighting/lat_long_image.h"

namespace lightwell::bench {
namespace {

void write_maps(const std::filesystem::path& folder, const std::vector<NamedMap>& maps,
                const std::vector<int>& counts) {
  nlohmann::json index = {{"counts", counts}, {"maps", nlohmann::json::array()}};
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const LatLongImage image = lat_long_from_polar_map(maps[i].map);
    const std::string file = std::to_string(i) + ".f32";
    std::ofstream out(folder / file, std::ios::binary);
    for (const Rgb& pixel : image.pixels)
      out.write(reinterpret_cast<const char*>(pixel.data()), 3 * sizeof(float));
    index["maps"].push_back({{"file", file}, {"width", image.width}, {"height", image.height}});
  }
  std::ofstream(folder / "maps.json") << index;
}

// A line of the script's output: {"peer", "map", "lights", "ms", "direction": [[x, y, z]…], "illuminance": […]}.
void take_line(const std::string& line, std::vector<PythonPeer>& peers) {
  const auto json = nlohmann::json::parse(line);
  const std::string name = json.at("peer");
  auto peer = std::find_if(peers.begin(), peers.end(), [&](const PythonPeer& p) { return p.name == name; });
  if (peer == peers.end()) peer = peers.insert(peers.end(), {name, {}});
  PeerSet made{json.at("map"), json.at("lights"), json.at("ms"), {}};
  for (std::size_t i = 0; i < json.at("direction").size(); ++i) {
    const auto d = json["direction"][i].get<std::array<float, 3>>();
    const auto e = json.at("illuminance").at(i).get<std::array<float, 3>>();
    made.set.lights.push_back({{d[0], d[1], d[2]}, {e[0], e[1], e[2]}, -1, 0});
  }
  peer->sets.push_back(std::move(made));
}

// Whether the script ran to its end.
bool run_script(const std::filesystem::path& script, const std::filesystem::path& maps,
                std::vector<PythonPeer>& peers) {
  FILE* pipe =
      popen(("python3 " + shell_quoted(script.string()) + " " + shell_quoted(maps.string())).c_str(), "r");
  if (pipe == nullptr) return false;
  bool good = true;
  char* line = nullptr;
  std::size_t room = 0;
  while (getline(&line, &room, pipe) >= 0) {
    try {
      take_line(line, peers);
    } catch (const nlohmann::json::exception& e) {
      std::fprintf(stderr, "%s: %s\n", script.filename().c_str(), e.what());
      good = false;
      break;
    }
  }
  std::free(line);  // getline's
  const int status = pclose(pipe);
  return good && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

std::vector<PythonPeer> python_peers(const std::filesystem::path& folder, const std::vector<NamedMap>& maps,
                                     const std::vector<int>& counts) {
  if (folder.empty()) {
    std::fprintf(stderr, "left out: peers in Python (--peers bench/peers)\n");
    return {};
  }
  std::vector<std::filesystem::path> scripts;
  if (std::filesystem::is_directory(folder))
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      if (entry.path().extension() == ".py") scripts.push_back(entry.path());
  std::sort(scripts.begin(), scripts.end());
  const TemporaryFolder temporary;
  if (scripts.empty() || temporary.path().empty()) {
    std::fprintf(stderr, "left out: %s holds no peers\n", folder.c_str());
    return {};
  }
  write_maps(temporary.path(), maps, counts);
  std::vector<PythonPeer> peers;
  for (const std::filesystem::path& script : scripts) {
    std::vector<PythonPeer> made;
    if (!run_script(script, temporary.path(), made)) {
      std::fprintf(stderr, "left out: %s\n", script.filename().c_str());
      continue;
    }
    for (PythonPeer& peer : made) peers.push_back(std::move(peer));
  }
  return peers;
}

}  // namespace lightwell::bench
