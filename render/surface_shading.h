// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>

#include "render/camera.h"
#include "render/casters.h"
#include "render/gbuffer.h"
#include "render/light_lists.h"
#include "render/light_rows.h"
#include "render/shading_facts.h"
#include "render/shadow_atlas.h"

namespace lightwell::render {

struct ShadingOptions {
  ShadowLookUp shadows;
  int interleave =
      1;  // pixels a side of the square over which weak lights are spread (light_subsets.h); 1: each takes all
};

// Lights the surfaces that a G-buffer shows, one block of lights after the other (shade_fragment.glsl).
class SurfaceShading {
 public:
  static Result<SurfaceShading> create(const Scene& scene, bool nothing_casts, const ShadingOptions& options);
  // depth: of the G-buffer
  Status resize(int width, int height, GLuint depth);
  // For shade() with shadows = false.
  Status make_unshadowed();
  // Each pixel takes the lights that its normal's region lists (light_lists.h), or looks at all; the picture is the same.
  Status use_light_lists(bool on);

  // The lights that shade() draws, at most kMaxLightsPerBlock, with their maps, all on one page of the atlas.
  // all: of the picture, among them these
  void set_lights(std::span<const LightRow> lights, std::span<const LightRow> all, int shadow_page);

  struct Target {
    GLuint framebuffer;  // with the G-buffer's depth
    GLuint so_far;       // the sum of earlier blocks and samples
    bool start_sum;      // so_far is not there yet
    int width, height;
  };
  // Of one sample of the picture.
  struct Sample {
    const View& view;
    Rgb ambient;
    bool first_block;  // ambient light and emission are drawn with it
    bool last_block;
    float weight;
  };
  void shade(bool shadows, const Sample& sample, const Target& target, const GBuffer& gbuffer,
             const ShadowAtlas& atlas, const Casters& casters) const;

 private:
  struct Programs {
    gl::Program whole, subsets, filtered;
  };
  Result<Programs> make_programs(bool shadows, bool lists) const;
  // Made when they are first needed.
  Status make_if_missing(bool shadows, bool lists);
  void draw(const gl::Program& program, const Sample& sample, const GBuffer& gbuffer,
            const ShadowAtlas& atlas, const Casters& casters) const;

  int width_ = 0;
  int height_ = 0;
  int interleave_ = 1;
  std::string models_, look_up_, no_look_up_;
  std::array<std::array<Programs, 2>, 2> programs_;  // [with shadows][with lists]
  bool lists_ = false;
  LightLists light_lists_;
  gl::Buffer light_block_;
  gl::VertexArray no_vertices_;
  gl::Texture subsets_;  // interleave.glsl
  gl::Framebuffer subsets_target_;
  int shadow_page_ = 0;
  int lights_ = 0;
  int strong_ = 0;                      // the first of them
  Rgb weak_illuminance_ = Rgb::Zero();  // of the others together
};

}  // namespace lightwell::render
