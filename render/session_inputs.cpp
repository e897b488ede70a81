// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/session_inputs.h"

#include <algorithm>
#include <cstdio>
#include <limits>

#include "interface/light_set_io.h"
#include "render/camera.h"
#include "render/live_field_light.h"

namespace lightwell::render {
namespace {

bool has_power(const DirectionalLight& light) {
  return light.illuminance.maxCoeff() > 0;
}

constexpr int kLiveLights = 72;  // what two cores without a GPU draw several times a second

}  // namespace

Result<ChosenCamera> choose_camera(const Scene& scene, const Options& options) {
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    const SceneCamera& camera = scene.cameras[i];
    if (options.camera.empty() || camera.name == options.camera || camera.node_name == options.camera)
      return ChosenCamera{camera, i};
  }
  if (!options.camera.empty()) {
    std::string names;
    for (const SceneCamera& camera : scene.cameras)
      names += (names.empty() ? "'" : ", '") + camera.name + "'";
    return Error{ErrorKind::usage, "--camera " + options.camera + ": not in " + options.scene.string() +
                                       (names.empty() ? ", which has none" : ", which has " + names)};
  }
  return ChosenCamera{fitted_camera(scene), std::nullopt};
}

namespace {

struct Bounds {
  Vec3f low = Vec3f::Constant(std::numeric_limits<float>::max());
  Vec3f high = -low;
};

Bounds bounds_of(const Scene& scene) {
  Bounds bounds;
  for (const std::uint32_t i : scene.indices) {
    bounds.low = bounds.low.cwiseMin(scene.vertices[i].position);
    bounds.high = bounds.high.cwiseMax(scene.vertices[i].position);
  }
  return bounds;
}

std::string text_of(const Vec3d& low, const Vec3d& high) {
  char text[160];
  std::snprintf(text, sizeof text, "(%.3g, %.3g, %.3g) to (%.3g, %.3g, %.3g)", low.x(), low.y(), low.z(),
                high.x(), high.y(), high.z());
  return text;
}

}  // namespace

float white_floor_cd_m2(const LightField& field, const Vec3d& place) {
  const Vec3d inside = place.cwiseMax(field.grid.low).cwiseMin(field.grid.high);
  const Rgbd lux = irradiance(light_at(field, inside), Vec3d::UnitY());
  return static_cast<float>(std::max(0.0, luminance(lux)) / kPi);
}

float white_floor_cd_m2(const LightSet& lights) {
  double sum = luminance(lights.ambient);
  for (const DirectionalLight& light : lights.lights)
    sum += luminance(light.illuminance) * std::max(light.direction.y(), 0.0f) / kPi;
  return static_cast<float>(sum);
}

std::string remark_on_reach(const Scene& scene, const LightField& field, const std::string& name) {
  if (scene.indices.empty()) return {};
  const Bounds bounds = bounds_of(scene);
  const Vec3d low = bounds.low.cast<double>(), high = bounds.high.cast<double>();
  if (field.grid.contains(low) && field.grid.contains(high)) return {};
  return name + " reaches over " + text_of(field.grid.low, field.grid.high) + " m, the scene over " +
         text_of(low, high) + ": beyond the field the light at its border is taken";
}

std::vector<std::string> remarks_on(const Scene& scene, const ChosenCamera& camera, const LightSource& source,
                                    const Options& options) {
  std::vector<std::string> remarks;
  const std::string file = options.scene.string();
  if (scene.dropped_triangles > 0)
    remarks.push_back(file + ": " + std::to_string(scene.dropped_triangles) +
                      " triangles of no area left out");
  for (const std::string& what : scene.left_out) remarks.push_back(file + ": " + what + " left out");
  for (const std::string& remark : scene.remarks) remarks.push_back(file + ": " + remark);
  if (!camera.of_scene)
    remarks.push_back(file + " has no perspective camera; one that sees all of it is used");
  if (const LightField* field = source.field(); field != nullptr)
    if (std::string remark = remark_on_reach(scene, *field, options.field.string()); !remark.empty())
      remarks.push_back(std::move(remark));
  const LightSet& set = source.lights();
  if (!options.light_set.empty() && std::none_of(set.lights.begin(), set.lights.end(), has_power))
    remarks.push_back(
        options.light_set.string() + ": no light has power" +
        (set.ambient.maxCoeff() > 0 ? ", only its ambient light is seen" : "; the picture is black"));
  if (options.probe && !options.luminaires.empty())
    remarks.push_back("--probe: the balls show the light from far away, without the lamps");
  if (options.probe && !options.light_set.empty())
    remarks.push_back("--probe: a light set has no picture of its environment; without the mirror ball");
  return remarks;
}

Result<std::unique_ptr<LightSource>> open_lights(const Options& options) {
  if (options.live) {
    LiveOptions live;
    live.dds = {options.domain, options.interface};
    live.max_lights = options.shadow_maps > 0 ? options.shadow_maps : kLiveLights;
    live.with_environment = options.background_environment || options.probe;
    return live_lights(live);
  }
  if (options.live_field) return live_field_light({options.domain, options.interface});
  if (!options.field.empty()) return field_light(options.field);
  if (!options.environment.empty())
    return environment_lights({options.environment, options.lights, options.method, options.coverage,
                               options.spin_deg, options.shadow_maps});
  if (!options.has_lights()) return fixed_lights({}, 0);  // lamps alone
  auto set = read_light_set(options.light_set);
  if (!set) return set.error();
  return fixed_lights(*set, options.shadow_maps);
}

Status check_outputs(const Options& options) {
  std::vector<std::filesystem::path> files;
  for (const FrameName& name : options.outputs) files.push_back(name.file(0));
  if (!options.stats.empty()) files.push_back(options.stats);
  for (const auto& file : files) {
    const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
    std::error_code ignored;
    if (!std::filesystem::is_directory(folder, ignored))
      return Error{ErrorKind::failed, file.string() + ": folder " + folder.string() + " does not exist"};
  }
  return {};
}

}  // namespace lightwell::render
