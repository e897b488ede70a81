// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lighting/lat_long_image.h"
#include "lighting/light_set.h"
#include "render/picture.h"
#include "render/scene.h"

namespace lightwell::render {

// The balls by which crews check light, as a camera far away sees them (parallel rays), turned as the scene's camera.
// Alpha 1 inside the disc, which touches the picture's sides, 0 outside. No shadows: nothing is near them.
inline constexpr float kGreyBallAlbedo = 0.18f;

// Lambertian: albedo/π · Σ illuminance · max(0, n·d) + albedo · ambient.
RadiancePicture grey_ball(const LightSet& lights, const Mat4f& world_from_camera, int diameter);

// A perfect mirror: the environment's radiance where the ray goes on to, bilinear. environment_turn_rad: turn of the
// image about +Y (azimuth λ comes to λ + angle).
RadiancePicture mirror_ball(const LatLongImage& environment, double environment_turn_rad,
                            const Mat4f& world_from_camera, int diameter);

}  // namespace lightwell::render
