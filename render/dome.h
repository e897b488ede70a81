// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lighting/light_set.h"
#include "render/bounding_sphere.h"
#include "render/camera.h"

namespace lightwell::render {

// What a view shows of the dome from which the lights come, in pixels from the upper left corner of a picture.
struct DomeMarker {
  Vec2f place = Vec2f::Zero();
  float radius_px = 0;       // its area is the light's share of the luminance
  Rgb colour = Rgb::Zero();  // of the light, its largest component 1
  bool in_front = true;      // of the dome's centre, as the eye sees it
};

// The lights that have power and are seen in the picture, dimmest first. dome: where they come from.
std::vector<DomeMarker> dome_markers(std::span<const DirectionalLight> lights, const Sphere& dome,
                                     const View& view, int width, int height);

// The horizon, then the meridians of azimuth 0°, 45°, …: lines of points, broken where they are not seen.
std::vector<std::vector<Vec2f>> dome_lines(const Sphere& dome, const View& view, int width, int height);

}  // namespace lightwell::render
