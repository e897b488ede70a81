// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lighting/lat_long_image.h"

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

// A scene of any number of triangles, for growth: balls in a row, about so many triangles together, at least 1000.
std::string balls_gltf(int triangles);

}  // namespace lightwell::pictures
