// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/session_inputs.h"

#include <algorithm>

#include "interface/light_set_io.h"
#include "render/camera.h"

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

float white_floor_cd_m2(const LightSet& lights) {
  double sum = luminance(lights.ambient);
  for (const DirectionalLight& light : lights.lights)
    sum += luminance(light.illuminance) * std::max(light.direction.y(), 0.0f) / kPi;
  return static_cast<float>(sum);
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
  const LightSet& set = source.lights();
  if (!options.light_set.empty() && std::none_of(set.lights.begin(), set.lights.end(), has_power))
    remarks.push_back(
        options.light_set.string() + ": no light has power" +
        (set.ambient.maxCoeff() > 0 ? ", only its ambient light is seen" : "; the picture is black"));
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
  if (!options.environment.empty())
    return environment_lights({options.environment, options.lights, options.method, options.coverage,
                               options.spin_deg, options.shadow_maps});
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
