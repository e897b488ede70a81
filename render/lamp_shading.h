// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/lamp_detail.h"
#include "render/lamp_maps.h"
#include "render/placed_lamp.h"
#include "render/surface_shading.h"

namespace lightwell::render {

struct LampOptions {
  int shadow_size = 256;         // texels a side of a source's map
  bool simplify_casters = true;  // RendererOptions::simplify_casters
  double max_error = 0.01;       // of taking positions together (LampDetail); 0: every one is drawn
};

// Lights the surfaces that a G-buffer shows by lamps: every source of theirs a projected image with a shadow map
// (lamp_fragment.glsl). A lamp's near and far field are drawn one after the other.
class LampShading {
 public:
  static LampShading create(const Scene& scene, bool nothing_casts, const LampOptions& options);

  // The lamps as they now stand. One that is there already keeps what did not change: one that stays keeps its maps.
  // casters: on which the detail depends.
  // bad_input: more light in an image than numbers hold; failed: what the driver cannot do
  Status set(std::span<const PlacedLamp> lamps, const Casters& casters);
  // The scene that it was made of moved; by so much at most what casts.
  void follow(const Scene& scene, float farthest_m);
  // Before a frame: which positions are drawn together follows a scene that moved under lamps that rest. Errors as of set().
  Status follow_detail(const Casters& casters) { return surfaces_moved_ ? choose_groups(casters) : Status(); }

  // What casts, by how fine it is to be: for maps up to shadow_size, and for larger ones and lamps nearby.
  struct AllCasters {
    const Casters& coarse;
    const Casters* fine;  // nullptr: there are none
    const ShadowAtlas& buffers;
    const CutoutCasters& cutouts;
  };
  // Draws the maps that do not stand.
  Status draw_maps(const AllCasters& casters);

  // Near and far fields that shine.
  [[nodiscard]] std::size_t passes() const;
  // Adds one of them. pixel_tangent: width of what a pixel shows at a metre
  Status shade(std::size_t pass, bool shadows, const SurfaceShading::Sample& sample,
               const SurfaceShading::Target& target, const GBuffer& gbuffer);

  struct Counts {
    std::size_t lamps = 0;      // that shine
    std::size_t positions = 0;  // theirs; a far field is one
    std::size_t sources = 0;    // drawn for them
    std::size_t maps = 0;
    std::size_t maps_drawn = 0;  // by the last draw_maps()
    int map_side = 0;            // of the smallest
    std::size_t bytes = 0;       // of images and maps
  };
  [[nodiscard]] Counts counts() const;

 private:
  // A near or a far field in the driver.
  struct Part {
    LampSources sources;  // without their pixels
    gl::Texture images;
    gl::Buffer block;
    Rgb candela = Rgb::Zero();  // of the images' 1
    std::size_t bytes = 0, positions = 1;
    LampMaps maps;
    bool stale = true;
  };
  struct Drawn {
    PlacedLamp lamp;
    LampDetail detail;
    int group = 0;
    std::optional<Part> near, far;
    std::vector<Vec3d> chosen_for;  // places that it lit, in its frame, when its group was chosen
    bool chosen = false;
  };
  struct Program {
    SourceMap map;
    int faces;  // 0: without shadows
    gl::Program program;
  };
  Result<Part> upload(LampSources sources) const;
  Status choose_groups(const Casters& casters);
  Status choose_group(Drawn& drawn, const Casters& casters);
  Status draw_maps(Drawn& drawn, Part& part, const AllCasters& casters);
  void fill_block(Part& part) const;
  Result<const gl::Program*> program(SourceMap map, int faces);
  [[nodiscard]] std::pair<const Drawn*, const Part*> pass(std::size_t number) const;

  LampOptions options_;
  MaterialKinds kinds_;
  bool nothing_casts_ = false;
  Receivers receivers_;
  std::optional<CasterOutlines> outlines_;  // made when they are first asked for
  bool surfaces_moved_ = false;             // since groups were chosen
  std::vector<Drawn> lamps_;
  std::vector<Program> programs_;
  gl::Program map_program_;
  gl::VertexArray no_vertices_;
  std::size_t maps_drawn_ = 0;
};

}  // namespace lightwell::render
