// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>

#include "bench/pictures/ray_tracer.h"
#include "bench/render_suite.h"
#include "lighting/decomposition/decompose.h"

namespace lightwell::bench {
namespace {

constexpr int kLights = 72;
constexpr double kMostShare = 1.0 / 2048;  // of a reference's light

// Errors over the pixels of each primitive, by the renderer at its defaults.
std::vector<pictures::PictureError> errors_on_primitives(const render::Scene& scene,
                                                         const LatLongImage& light) {
  const auto tracer = pictures::RayTracer::create(scene);
  auto renderer = renderer_of(scene, 256);
  const auto lights = decompose(polar_map_from_lat_long(light, true), Method::best, kLights);
  const render::SceneCamera& camera = scene.cameras.at(0);
  if (!tracer || !renderer || !lights || !renderer->render(*lights, camera)) return {};
  const pictures::Reference whole = pictures::reference_of(tracer->picture(
      camera, pictures::kPictureWidth, pictures::kPictureHeight, pictures::exact_lights(light, kMostShare)));
  const std::vector<int> shown =
      tracer->primitives(camera, pictures::kPictureWidth, pictures::kPictureHeight);
  const std::vector<Rgb> ours = pictures::colours_of(renderer->radiance());
  std::vector<pictures::PictureError> errors;
  for (std::size_t p = 0; p < scene.primitives.size(); ++p) {
    pictures::Reference reference = whole;
    for (std::size_t i = 0; i < shown.size(); ++i)
      if (shown[i] != static_cast<int>(p)) reference.mask[i] = 0;
    errors.push_back(pictures::picture_error(ours, reference));
  }
  return errors;
}

// The same albedo without gloss.
render::Scene made_matte(render::Scene scene) {
  for (render::Material& material : scene.materials) {
    material.base_color += material.specular;
    material.specular = Rgb::Zero();
  }
  return scene;
}

}  // namespace

std::vector<Row> render_gloss_rows() {
  std::vector<Row> rows;
  for (const pictures::JudgedScene& judged : pictures::judged_scenes()) {
    if (judged.name != "phong") continue;
    const auto scene = pictures::read_judged(judged);
    if (!scene) continue;
    const LatLongImage light = judged.light();
    const auto glossy = errors_on_primitives(*scene, light);
    const auto matte = errors_on_primitives(made_matte(*scene), light);
    for (std::size_t p = 0; p < std::min(glossy.size(), matte.size()); ++p) {
      const render::Material& material =
          scene->materials[static_cast<std::size_t>(scene->primitives[p].material)];
      if (!(material.specular.maxCoeff() > 0)) continue;
      constexpr double kNotTimed = std::numeric_limits<double>::quiet_NaN();
      Row row{"gloss",
              "exponent " + std::to_string(static_cast<int>(material.exponent)),
              {kNotTimed, kNotTimed, kNotTimed, 0},
              {}};
      row.values = {{"relative_rmse", glossy[p].relative_rmse},
                    {"matte_relative_rmse", matte[p].relative_rmse},
                    {"gloss_over_matte", glossy[p].relative_rmse / matte[p].relative_rmse},
                    {"exponent", static_cast<double>(material.exponent)}};
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

}  // namespace lightwell::bench
