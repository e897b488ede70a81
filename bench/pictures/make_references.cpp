// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <string>
#include <thread>

#include "bench/pictures/judged_scenes.h"
#include "bench/pictures/picture_error.h"
#include "bench/pictures/ray_tracer.h"
#include "interface/atomic_file.h"
#include "interface/environment_io.h"
#include "render/gltf_scene.h"

// make_references scenes FOLDER: writes every judged scene and its light there.
// make_references pictures FOLDER REFERENCES [NAME]: that, and traces the stored references, or only that of a scene.
namespace {

using namespace lightwell;  // NOLINT(google-build-using-namespace)

Status make(const pictures::JudgedScene& judged, const std::filesystem::path& folder,
            const std::filesystem::path& references) {
  const std::string name(judged.name);
  const auto scene_file = folder / (name + ".gltf");
  const LatLongImage light = judged.light();
  if (Status s = write_file_atomically(scene_file, judged.gltf()); !s) return s;
  if (Status s = write_environment(folder / (name + "_light.exr"), light); !s) return s;
  if (references.empty()) return {};
  const auto scene = render::read_gltf(scene_file);
  if (!scene) return scene.error();
  const auto tracer = pictures::RayTracer::create(*scene, pictures::Edges::watertight);
  if (!tracer) return tracer.error();
  const std::vector<DirectionalLight> lights = pictures::exact_lights(light);
  std::fprintf(stderr, "%s: %zu lights, %zu triangles\n", name.c_str(), lights.size(), scene->triangles());
  const auto picture =
      tracer->picture(scene->cameras.at(0), pictures::kPictureWidth, pictures::kPictureHeight, lights,
                      static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
  return pictures::write_reference(references / (name + ".exr"), pictures::reference_of(picture));
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  if (!(what == "scenes" && argc == 3) && !(what == "pictures" && (argc == 4 || argc == 5))) {
    std::fprintf(stderr, "usage: make_references scenes FOLDER | pictures FOLDER REFERENCES [NAME]\n");
    return 2;
  }
  for (const pictures::JudgedScene& judged : pictures::judged_scenes()) {
    if (argc == 5 && judged.name != argv[4]) continue;
    if (const Status s = make(judged, argv[2], argc > 3 ? argv[3] : ""); !s) {
      std::fprintf(stderr, "make_references: %s\n", s.error().message.c_str());
      return static_cast<int>(s.error().kind);
    }
  }
  return 0;
}
