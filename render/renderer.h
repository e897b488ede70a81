// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "lighting/lat_long_image.h"
#include "lighting/light_set.h"
#include "render/camera.h"
#include "render/casters.h"
#include "render/compositor.h"
#include "render/cutout_casters.h"
#include "render/gbuffer.h"
#include "render/picture.h"
#include "render/shadow_atlas.h"
#include "render/tone_mapper.h"

namespace lightwell::render {

struct RendererOptions {
  int width = 320;
  int height = 240;
  int samples = 1;               // a pixel: 1 at its centre, more spread over it, averaged
  int shadow_size = 256;         // texels a side of a light's map
  bool simplify_casters = true;  // shadows of simpler meshes, a quarter of a map's texel off at most
  bool measure_passes = false;   // waits for each pass, to time it
};

struct PassTimes {
  double shadow_ms = 0;
  double gbuffer_ms = 0;
  double shading_ms = 0;
  double tonemap_ms = 0;
};

// Deferred rendering of a scene under directional lights, all of them with shadow maps. Works in the context
// that is current when it is created. Lights beyond what one uniform block or one atlas holds go in further
// passes: their number is not limited.
class Renderer {
 public:
  // bad_input: a texture too large for the driver; failed: what the driver cannot do.
  static Result<Renderer> create(const Scene& scene, const RendererOptions& options);

  // Follows these primitives of the scene that it was made of, which moved (SceneMotion::moved).
  void move(const Scene& scene, std::span<const std::size_t> moved);
  Status resize(int width, int height);
  // Shown where no surface is; row 0 is the zenith. nullptr: nothing, with alpha 0.
  void set_environment(const LatLongImage* image);
  // Behind everything, with the objects' shadows on it (Compositor). white: radiance of the plate's 1.
  Status set_plate(const Plate& plate, float white);
  // environment_turn_rad turns the shown environment about +Y (a light at azimuth λ comes to λ + angle).
  Status render(const LightSet& lights, const SceneCamera& camera, double environment_turn_rad = 0);
  void tone_map(ToneMap operation, double dt_s);
  void present() const { tone_mapper_.draw_to_window(shown().texture); }

  [[nodiscard]] RadiancePicture radiance() const;
  [[nodiscard]] DisplayPicture display() const { return tone_mapper_.read(); }
  // Waits until everything is drawn.
  static void finish() { glFinish(); }
  // Maps drawn for the last frame: one a light that has power; 0 where nothing casts.
  [[nodiscard]] std::size_t shadow_maps() const { return shadow_maps_; }
  [[nodiscard]] const PassTimes& pass_times() const { return times_; }
  [[nodiscard]] static std::string gl_renderer();
  // Largest side of a picture.
  [[nodiscard]] static int size_limit();

 private:
  struct Sum {
    gl::Texture texture;
    gl::Framebuffer framebuffer;
  };
  // Read one, write the other: float blending is not guaranteed.
  struct Sums {
    Sum sum[2];
    int current = 0;
    [[nodiscard]] const Sum& last() const { return sum[current]; }
  };
  struct Shown {
    GLuint texture;
    GLuint framebuffer;
  };
  [[nodiscard]] Shown shown() const;
  Status resize(Sums& sums) const;
  Status render_samples(std::span<const LightRow> rows, const LightSet& lights, const SceneCamera& camera,
                        int first_sample, int end_sample, double environment_turn_rad);
  // Adds the block of lights and, with the first of a sample, what does not depend on them.
  void shade(const View& view, int light_count, const LightSet& lights, bool first_block, bool start_sum,
             float weight, double environment_turn_rad);
  void shade_surfaces(const gl::Program& program, Sums& sums, const View& view, int light_count,
                      const LightSet& lights, bool first_block, bool start_sum, float weight);
  // Adds the time since start to a pass, where passes are measured.
  double lap(double start, double& pass) const;

  RendererOptions options_;
  GBuffer gbuffer_;
  ShadowAtlas atlas_;
  CutoutCasters cutouts_;
  ToneMapper tone_mapper_;
  Casters casters_;
  gl::Program surfaces_;
  gl::Program background_;
  gl::Buffer light_block_;
  gl::VertexArray no_vertices_;
  gl::Texture environment_;
  bool show_environment_ = false;
  Sums sums_;
  // Over a plate: light as if nothing cast a shadow.
  std::optional<Compositor> compositor_;
  std::string shading_defines_;
  gl::Program unshadowed_;
  Sums unshadowed_sums_;
  PassTimes times_;
  std::size_t shadow_maps_ = 0;
  bool nothing_casts_ = false;
};

}  // namespace lightwell::render
