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
#include "render/field_balls.h"
#include "render/field_shading.h"
#include "render/gbuffer.h"
#include "render/graphics_reset.h"
#include "render/lamp_shading.h"
#include "render/picture.h"
#include "render/shadow_atlas.h"
#include "render/surface_shading.h"
#include "render/tone_mapper.h"

namespace lightwell::render {

struct RendererOptions {
  int width = 320;
  int height = 240;
  int samples = 1;        // a pixel: 1 at its centre, more spread over it, averaged
  int shadow_size = 256;  // texels a side of a light's map
  bool texels_by_power =
      true;  // strong lights have maps of up to kLargestMap times the side, weak ones smaller ones
  bool simplify_casters = true;  // shadows of simpler meshes, a quarter of a map's texel off at most
  bool soft_edges = false;       // of shadows, as wide as their lights make them; else those of points
  // Pixels a side of the square over which weak lights are spread, 1, 2 or 4; 1: each pixel takes all lights.
  int interleave = 2;
  bool light_lists = false;     // SurfaceShading::use_light_lists
  bool measure_passes = false;  // waits for each pass, to time it
  // Of taking positions of a lamp together (LampDetail); 0: every one is drawn.
  double lamp_error = 0.01;
  // Balls of a field that is set; the scene's last material is theirs (field_ball_material).
  std::optional<FieldBallsOptions> field_balls;
};

struct PassTimes {
  double shadow_ms = 0;
  double gbuffer_ms = 0;
  double shading_ms = 0;
  double tonemap_ms = 0;
};

// Deferred rendering of a scene under directional lights, all of them with shadow maps. Works in the context
// that is current when it is created. Lights beyond what one uniform block or one page of maps holds go in
// further passes: their number is not limited.
class Renderer {
 public:
  // bad_input: a texture too large for the driver; failed: what the driver cannot do.
  static Result<Renderer> create(const Scene& scene, const RendererOptions& options);

  // Follows these primitives of the scene that it was made of, which moved (SceneMotion::moved); in each map once they may
  // be kMovedTexels off there.
  void move(const Scene& scene, std::span<const std::size_t> moved);
  Status resize(int width, int height);
  // Shown where no surface is; row 0 is the zenith. nullptr: nothing, with alpha 0.
  void set_environment(const LatLongImage* image);
  // Behind everything, with the objects' shadows on it (Compositor). white: radiance of the plate's 1.
  Status set_plate(const Plate& plate, float white);
  // From now on render() takes this light field in place of its lights; its main lights cast shadows.
  // bad_input: larger than the driver's 3D textures
  Status set_field(const LightField& field, const MainLights& main_lights);
  // nullptr: none is set.
  [[nodiscard]] const FieldShading* field() const { return field_ ? &*field_ : nullptr; }
  // 0 before a field is set.
  [[nodiscard]] std::size_t field_balls() const { return field_ && balls_ ? balls_->count() : 0; }
  // From now on these lamps shine beside the lights or the field; what did not change keeps its maps.
  // bad_input, failed: LampShading::set
  Status set_lamps(std::span<const PlacedLamp> lamps);
  [[nodiscard]] const LampShading& lamps() const { return lamps_; }
  // environment_turn_rad turns the shown environment about +Y (a light at azimuth λ comes to λ + angle).
  Status render(const LightSet& lights, const SceneCamera& camera, double environment_turn_rad = 0);
  // Puts opaque pixels of a picture over the last one rendered. left, bottom: pixels from its lower left corner.
  Status lay_over(const RadiancePicture& picture, int left, int bottom);
  void set_look(const Look& look) { tone_mapper_.set_look(look); }
  [[nodiscard]] double exposure_ev100() const { return tone_mapper_.exposure_ev100(); }
  // Of the texels that the shadow maps' size asks for, in (0, 1].
  void set_shadow_texels(double share) { atlas_.set_share(share); }
  // Light as if nothing cast shadows, or with them.
  Status set_shadows(bool on);
  // Each pixel takes the lights that its normal's region lists, or looks at all: the same picture.
  Status set_light_lists(bool on) { return surfaces_.use_light_lists(on); }
  // Bounds what casts shadows, but for what supports the scene; without such all that is seen.
  [[nodiscard]] const Sphere& object_bounds() const {
    return casters_.objects.radius > 0 ? casters_.objects : casters_.scene;
  }
  // What casts but is smaller than a texel of the largest map that a light may have: its shadow is lost.
  struct LostShadows {
    std::size_t objects = 0, of = 0;
    float texel_m = 0;
  };
  [[nodiscard]] LostShadows lost_shadows() const;
  void tone_map(double dt_s);
  // The same with another operator, which stays.
  void tone_map(ToneMap operation, double dt_s);
  void present() const { tone_mapper_.draw_to_window(shown().texture); }

  [[nodiscard]] int width() const { return options_.width; }
  [[nodiscard]] int height() const { return options_.height; }
  [[nodiscard]] RadiancePicture radiance() const;
  [[nodiscard]] DisplayPicture display() const { return tone_mapper_.read(); }
  // failed: the context is lost (GraphicsReset), or the driver failed: the last picture may be wrong.
  [[nodiscard]] Status check() const { return reset_.check(); }
  // Waits until everything is drawn.
  static void finish() { glFinish(); }
  // Maps of the last frame: one a light that has power, and those of lamps; 0 where nothing casts.
  [[nodiscard]] std::size_t shadow_maps() const { return shadow_maps_; }
  // Of these, drawn for it: the others stood from frames before.
  [[nodiscard]] std::size_t shadow_maps_drawn() const { return shadow_maps_drawn_; }
  // Side of the last frame's largest map, texels.
  [[nodiscard]] int largest_map() const { return atlas_.largest(); }
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
  void find_casters(const Scene& scene, bool fine_ones);
  Status resize(Sums& sums) const;
  Status render_samples(std::span<LightRow> rows, const LightSet& lights, const SceneCamera& camera,
                        int first_sample, int end_sample, double environment_turn_rad);
  Result<std::vector<ShadowAtlas::Block>> blocks_of(std::span<LightRow> rows);
  // Adds the block of lights and, with the first of a sample, what does not depend on them.
  void shade(const SurfaceShading::Sample& sample, bool start_sum, double environment_turn_rad);
  void shade_surfaces(bool shadows, Sums& sums, const SurfaceShading::Sample& sample, bool start_sum) const;
  Status draw_lamp_maps();
  Status shade_lamps(const SurfaceShading::Sample& sample);
  void draw_background(GLuint so_far, const SurfaceShading::Sample& sample, bool start_sum,
                       bool show_environment, double environment_turn_rad) const;
  // Adds the time since start to a pass, where passes are measured.
  double lap(double start, double& pass) const;

  RendererOptions options_;
  GBuffer gbuffer_;
  ShadowAtlas atlas_;
  CutoutCasters cutouts_;
  ToneMapper tone_mapper_;
  Casters casters_;
  Casters fine_casters_;                  // for maps larger than shadow_size
  Sphere fitted_objects_, fitted_scene_;  // what the maps in the atlas were drawn for
  SurfaceShading surfaces_;
  MaterialKinds kinds_;
  std::optional<FieldShading> field_;
  std::optional<FieldBalls> balls_;
  LampShading lamps_;
  gl::Program background_;
  gl::Program lay_over_;  // made when it is first needed
  gl::VertexArray no_vertices_;
  gl::Texture environment_;
  bool show_environment_ = false;
  Sums sums_;
  // Light as if nothing cast a shadow.
  bool shadows_ = true;
  std::optional<Compositor> compositor_;
  Sums unshadowed_sums_;
  GraphicsReset reset_;
  PassTimes times_;
  std::size_t shadow_maps_ = 0;
  bool nothing_casts_ = false;
  std::size_t shadow_maps_drawn_ = 0;
};

}  // namespace lightwell::render
