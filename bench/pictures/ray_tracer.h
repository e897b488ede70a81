// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "lighting/lat_long_image.h"
#include "lighting/light_set.h"
#include "lighting/result.h"
#include "render/picture.h"
#include "render/scene.h"

namespace lightwell::pictures {

// Whether a ray may once in a million slip between two triangles that share an edge. Watertight takes twice the time.
enum class Edges { fast, watertight };

// Light that differs from place to place: fills in what a point receives. Called by several threads at once.
using LightsAt = std::function<void(const Vec3f& point, std::vector<DirectionalLight>& lights)>;

// Direct light with exact visibility: what a picture ought to be. The reflection models are written here anew, from
// docs/conventions.md and the glTF specification, so that an error in a shader is not repeated.
class RayTracer {
 public:
  // The scene must outlive it.    usage: a scene with textures, vertex colours, cut-outs or emission
  static Result<RayTracer> create(const render::Scene& scene, Edges edges = Edges::fast);
  RayTracer(RayTracer&&) noexcept;
  RayTracer& operator=(RayTracer&&) noexcept;
  ~RayTracer();

  // One ray through each pixel's centre, and from what it meets one toward every light. Lights that are many should
  // stand in an order that keeps neighbours near each other. alpha: 1 where a surface is.
  [[nodiscard]] render::RadiancePicture picture(const render::SceneCamera& camera, int width, int height,
                                                std::span<const DirectionalLight> lights,
                                                int threads = 1) const;
  // The same where each place has its own lights, all beyond the scene.
  [[nodiscard]] render::RadiancePicture picture(const render::SceneCamera& camera, int width, int height,
                                                const LightsAt& lights_at, int threads = 1) const;
  // What a lux from each light returns at each pixel: luminance of white light, [pixel][light].
  [[nodiscard]] std::vector<float> transport(const render::SceneCamera& camera, int width, int height,
                                             std::span<const DirectionalLight> lights) const;
  // The primitive that each pixel shows, row by row; −1: none.
  [[nodiscard]] std::vector<int> primitives(const render::SceneCamera& camera, int width, int height) const;

  struct Scenes;

 private:
  template <typename Lights>
  [[nodiscard]] render::RadiancePicture shade(const render::SceneCamera& camera, int width, int height,
                                              int threads, const Lights& lights_at) const;
  explicit RayTracer(std::unique_ptr<Scenes> scenes);
  std::unique_ptr<Scenes> scenes_;
};

// The upper half of an image as lights of which none carries more than most_share of the luminance, but for a pixel that
// would have to be cut into more than 16 × 16: faint pixels are taken together up to 4 × 4, bright ones cut. A pixel's
// light comes evenly from all of it.
std::vector<DirectionalLight> exact_lights(const LatLongImage& image, double most_share = 1.0 / 16384);

}  // namespace lightwell::pictures
