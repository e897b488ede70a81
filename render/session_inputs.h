// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/light_source.h"
#include "render/options.h"
#include "render/scene.h"

namespace lightwell::render {

struct ChosenCamera {
  SceneCamera camera;
  std::optional<std::size_t> of_scene;  // which of the scene's, whose motion it follows
};

// The camera of the options' name, else the scene's first, else one that sees all of it.
// usage: no camera has the name
Result<ChosenCamera> choose_camera(const Scene& scene, const Options& options);

// Light from where the options say.
Result<std::unique_ptr<LightSource>> open_lights(const Options& options);

// Luminance of a horizontal Lambertian surface of albedo 1 under the lights: what a camera shows as white that is
// exposed by an incident light meter.
float white_floor_cd_m2(const LightSet& lights);
// The same at a place of a field, or the nearest to it in the field.
float white_floor_cd_m2(const LightField& field, const Vec3d& place);

// That the scene reaches beyond the field, where it does; else empty.
std::string remark_on_reach(const Scene& scene, const LightField& field, const std::string& name);

// What of the scene and its light is shown otherwise than one may expect, a line each.
std::vector<std::string> remarks_on(const Scene& scene, const ChosenCamera& camera, const LightSource& source,
                                    const Options& options);

// Everything that cannot work is found before the first frame is rendered. failed: a folder is missing.
Status check_outputs(const Options& options);

}  // namespace lightwell::render
