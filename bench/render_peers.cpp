// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <sys/wait.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bench/render_suite.h"
#include "bench/temporary_folder.h"
#include "interface/atomic_file.h"
#include "interface/environment_io.h"

namespace lightwell::bench {
namespace {

using nlohmann::json;
using pictures::JudgedPicture;

Status write_scenes(const std::filesystem::path& folder, const std::vector<JudgedPicture>& judged) {
  json asked = {{"size", {pictures::kPictureWidth, pictures::kPictureHeight}},
                {"sides", {1, 2, 4, 8, 16}},
                {"scenes", json::array()}};
  for (const JudgedPicture& picture : judged) {
    for (const pictures::JudgedScene& scene : pictures::judged_scenes())
      if (scene.name == picture.name)
        if (Status s = write_file_atomically(folder / (picture.name + ".gltf"), scene.gltf()); !s) return s;
    if (Status s = write_environment(folder / (picture.name + "_light.exr"), picture.light); !s) return s;
    asked["scenes"].push_back(picture.name);
  }
  return write_file_atomically(folder / "pictures.json", asked.dump());
}

std::vector<Rgb> read_floats(const std::filesystem::path& file) {
  std::vector<Rgb> pixels(std::size_t{pictures::kPictureWidth} * pictures::kPictureHeight, Rgb::Zero());
  std::ifstream in(file, std::ios::binary);
  for (Rgb& pixel : pixels) in.read(reinterpret_cast<char*>(pixel.data()), 3 * sizeof(float));
  return pixels;
}

// {"peer", "scene", "samples", "ms", "cpu_ms", "file"}
Row row_of(const json& line, const std::filesystem::path& folder, const std::vector<JudgedPicture>& judged) {
  const std::string scene = line.at("scene");
  Row row{"picture, " + scene, line.at("peer"), timing_of({line.at("ms").get<double>()}), {}};
  row.values.emplace_back("cpu_ms", line.at("cpu_ms").get<double>());
  const std::vector<Rgb> picture = read_floats(folder / line.at("file").get<std::string>());
  for (const JudgedPicture& j : judged)
    if (j.name == scene) add_error(row, pictures::picture_error(picture, j.reference));
  row.values.emplace_back("samples", line.at("samples").get<double>());
  return row;
}

}  // namespace

std::vector<Row> mitsuba_rows(const std::vector<JudgedPicture>& judged, const Options& options) {
  const std::filesystem::path script =
      std::filesystem::path(options.peers_folder) / "render" / "mitsuba_pictures.py";
  std::vector<Row> rows;
  if (options.peers_folder.empty() || !std::filesystem::exists(script)) {
    std::fprintf(stderr, "left out: Mitsuba's pictures (--peers bench/peers)\n");
    return rows;
  }
  const TemporaryFolder folder;
  if (const Status s = write_scenes(folder.path(), judged); !s) {
    std::fprintf(stderr, "left out: %s\n", s.error().message.c_str());
    return rows;
  }
  FILE* pipe = popen(
      ("python3 " + shell_quoted(script.string()) + " " + shell_quoted(folder.path().string())).c_str(), "r");
  if (pipe == nullptr) return rows;
  char* line = nullptr;
  std::size_t room = 0;
  try {
    while (getline(&line, &room, pipe) >= 0) rows.push_back(row_of(json::parse(line), folder.path(), judged));
  } catch (const json::exception& e) {
    std::fprintf(stderr, "%s: %s\n", script.filename().c_str(), e.what());
  }
  std::free(line);  // getline's
  const int status = pclose(pipe);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    std::fprintf(stderr, "left out, wholly or in part: %s\n", script.filename().c_str());
  return rows;
}

}  // namespace lightwell::bench
