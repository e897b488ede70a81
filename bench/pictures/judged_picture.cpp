// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <thread>

#include "bench/pictures/judged_scenes.h"
#include "bench/pictures/ray_tracer.h"
#include "bench/temporary_folder.h"
#include "interface/atomic_file.h"
#include "render/gltf_scene.h"
#include "render/scene_writer.h"

namespace lightwell::pictures {
namespace {

Result<Reference> traced(const render::Scene& scene, const LatLongImage& light) {
  // A few thousand lights: their error is a tenth of what 72 err.
  constexpr double kMostShare = 1.0 / 2048;
  const auto tracer = RayTracer::create(scene);
  if (!tracer) return tracer.error();
  return reference_of(tracer->picture(scene.cameras.at(0), kPictureWidth, kPictureHeight,
                                      exact_lights(light, kMostShare),
                                      static_cast<int>(std::max(1u, std::thread::hardware_concurrency()))));
}

}  // namespace

Result<render::Scene> read_judged(const JudgedScene& judged) {
  const bench::TemporaryFolder folder;
  const auto file = folder.path() / "scene.gltf";
  if (Status s = write_file_atomically(file, judged.gltf()); !s) return s.error();
  return render::read_gltf(file);
}

Result<JudgedPicture> judged_picture(const JudgedScene& judged, const std::filesystem::path& references) {
  if (references.empty()) return judged_picture(judged, judged.light());
  auto scene = read_judged(judged);
  if (!scene) return scene.error();
  auto reference = read_reference(references / (std::string(judged.name) + ".exr"));
  if (!reference) return reference.error();
  return JudgedPicture{std::string(judged.name), std::move(scene).value(), judged.light(),
                       std::move(reference).value()};
}

Result<JudgedPicture> judged_picture(const JudgedScene& judged, LatLongImage light) {
  auto scene = read_judged(judged);
  if (!scene) return scene.error();
  auto reference = traced(*scene, light);
  if (!reference) return reference.error();
  return JudgedPicture{std::string(judged.name), std::move(scene).value(), std::move(light),
                       std::move(reference).value()};
}

render::Scene balls_scene(int triangles) {
  render::Scene scene;
  const auto add = [&](const render::Mesh& mesh, const render::Material& material, bool casts_shadow) {
    render::Primitive primitive;
    primitive.first_index = static_cast<std::uint32_t>(scene.indices.size());
    primitive.index_count = static_cast<std::uint32_t>(mesh.indices.size());
    primitive.material = static_cast<int>(scene.materials.size());
    primitive.casts_shadow = casts_shadow;
    const auto base = static_cast<std::uint32_t>(scene.vertices.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      render::Vertex vertex;
      vertex.position = mesh.positions[i];
      vertex.normal = mesh.normals[i];
      scene.vertices.push_back(vertex);
    }
    for (const std::uint32_t index : mesh.indices) scene.indices.push_back(base + index);
    scene.materials.push_back(material);
    scene.primitives.push_back(primitive);
  };
  add(render::ground_mesh(6), render::phong_material(Rgb::Constant(0.4f), Rgb::Zero(), 1), false);
  constexpr int kBalls = 5;
  // A ball of r rings and 2r sectors has 4 r (r − 1) triangles.
  const int rings = std::max(5, static_cast<int>(std::lround(std::sqrt(triangles / (4.0 * kBalls)) + 0.5)));
  for (int i = 0; i < kBalls; ++i)
    add(render::sphere_mesh({0.55f * static_cast<float>(i - 2), 0.3f, 0.3f * static_cast<float>(i % 2)},
                            0.25f, rings, 2 * rings),
        render::phong_material(Rgb::Constant(0.6f), Rgb::Zero(), 1), true);
  scene.cameras.push_back(render::camera_at("balls", {0.2f, 1.4f, 3.6f}, {0, 0.3f, 0}, 0.58f));
  return scene;
}

}  // namespace lightwell::pictures
