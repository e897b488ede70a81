// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "bench/pictures/picture_error.h"
#include "lighting/lat_long_image.h"
#include "lighting/result.h"
#include "render/scene.h"

// What the renderer's pictures are judged by: four scenes, each under its own light, all made by program.
namespace lightwell::pictures {

// Every object stands on a ground that receives shadows only. Metres; one camera, named as the scene; Lambertian but
// for the balls of `phong`.
//   poles   a ball, a torus and thin poles    under an unclipped sun
//   figure  a posed figure                    under night lamps
//   phong   balls of exponents 8, 40, 200     under windows
//   box     a knot in an open box             under an overcast sky
struct JudgedScene {
  std::string_view name;
  std::string (*gltf)();
  LatLongImage (*light)();  // cd/m², latitude–longitude, dark below the horizon
};
const std::vector<JudgedScene>& judged_scenes();

inline constexpr int kPictureWidth = 320;
inline constexpr int kPictureHeight = 240;

// As the renderer reads it.
Result<render::Scene> read_judged(const JudgedScene& judged);

// A judged scene with what its pictures are compared with.
struct JudgedPicture {
  std::string name;
  render::Scene scene;
  LatLongImage light;
  Reference reference;
};
// references: folder of the stored ones, or empty: traced anew, coarser, in seconds.
Result<JudgedPicture> judged_picture(const JudgedScene& judged, const std::filesystem::path& references);
// The same scene under another light, traced anew.
Result<JudgedPicture> judged_picture(const JudgedScene& judged, LatLongImage light);

// A scene of any number of triangles, for growth: five balls on the ground, about so many triangles together, at least 500.
render::Scene balls_scene(int triangles);

}  // namespace lightwell::pictures
