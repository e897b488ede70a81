// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/session.h"

#include <time.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>

#include "interface/atomic_file.h"
#include "render/egl_context.h"
#include "render/gltf_scene.h"
#include "render/kms_screen.h"
#include "render/light_budget.h"
#include "render/light_source.h"
#include "render/overlay.h"
#include "render/plate.h"
#include "render/probe_balls.h"
#include "render/renderer.h"
#include "render/say.h"
#include "render/scene_motion.h"
#include "render/screenshot.h"
#include "render/session_inputs.h"
#include "render/session_text.h"
#include "render/shown_field.h"
#include "render/shown_lamps.h"
#include "render/statistics.h"
#include "render/tracked_camera.h"
#include "render/window.h"

namespace lightwell::render {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t kManyTriangles = 1'000'000;

double cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

bool has_display() {
  return std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr;
}

class Session {
 public:
  Session(const Options& options, const std::atomic<bool>& stop, Scene& scene, ChosenCamera camera,
          LightSource& source, ShownLamps& lamps, PlateSource* plates, TrackingStream* tracking)
      : options_(options),
        stop_(stop),
        scene_(scene),
        motion_(scene),
        camera_(std::move(camera)),
        source_(source),
        lamps_(lamps),
        plates_(plates),
        tracking_(tracking),
        shown_field_(options),
        budget_({options.target_fps, options.max_error, options.shadow_size}),
        look_(options.look),
        show_probe_(options.probe),
        plate_white_cd_m2_(options.plate_white_cd_m2) {}

  Status prepare() {
    if (Status s = check_driver(); !s) return s;
    RendererOptions renderer_options;
    renderer_options.width = options_.width;
    renderer_options.height = options_.height;
    renderer_options.samples = options_.samples;
    renderer_options.shadow_size = options_.shadow_size;
    renderer_options.soft_edges = options_.soft_edges;
    renderer_options.interleave = options_.interleave;
    renderer_options.light_lists = options_.light_lists;
    renderer_options.measure_passes = !options_.stats.empty();
    renderer_options.lamp_error = options_.luminaire_error;
    renderer_options.field_balls = options_.field_balls;
    if (options_.field_balls) scene_.materials.push_back(field_ball_material(*options_.field_balls));
    auto renderer = Renderer::create(scene_, renderer_options);
    if (!renderer) return renderer.error();
    renderer_.emplace(std::move(renderer).value());
    renderer_->set_look(look_);
    if (Status s = place_lamps(); !s) return s;
    if (plates_ != nullptr)
      if (Status s = show_plate(); !s) return s;
    statistics_.shadow_size = options_.shadow_size;
    statistics_.triangles = scene_.triangles();
    statistics_.gl_renderer = Renderer::gl_renderer();
    return {};
  }

  // What a user should know of the picture that comes.
  void say_remarks() const {
    for (const std::string& remark : lamps_.remarks()) say(remark);
    for (const std::string& remark : remarks_on_lamps(options_.luminaires, lamps_.lamps(), scene_))
      say(remark);
    if (const int side = renderer_->lamps().counts().map_side; side > 0 && side < options_.shadow_size)
      say("lamps have so many positions that their shadow maps are of " + std::to_string(side) +
          " texels a side, where --shadow-size asks for " + std::to_string(options_.shadow_size));
    const Renderer::LostShadows lost = renderer_->lost_shadows();
    if (2 * lost.objects > lost.of)
      say(lost_shadows_text(options_.scene.string(), lost.objects, lost.of, lost.texel_m,
                            2 * renderer_->object_bounds().radius));
  }

  Status run_off_screen() {
    const std::optional<int> frames = options_.frames || options_.seconds || options_.light_is_live()
                                          ? options_.frames
                                          : std::optional<int>(1);
    while (!over(frames)) {
      const auto fresh = source_.update(frame_, std::chrono::milliseconds(20));
      if (!fresh) return fresh.error();
      // Live frames are as many as lights arrive: the same light twice would be the same picture.
      if (!source_.ready() || (options_.light_is_live() && !*fresh)) continue;
      if (Status s = show_newest_field(); !s) return s;
      if (!options_.field.empty() && renderer_->field() == nullptr) continue;
      if (Status s = move_scene(options_.light_is_live()); !s) return s;
      follow_tracking();
      if (Status s = render(camera_.camera); !s) return s;
    }
    if (frame_ == 0 && !stop_)
      return Error{ErrorKind::failed, "no light arrived on DDS domain " + std::to_string(options_.domain)};
    return finish();
  }

  Status run_screen(KmsScreen& screen) {
    while (!over(options_.frames)) {
      const auto fresh = source_.update(frame_, std::chrono::milliseconds(0));
      if (!fresh) return fresh.error();
      const auto [width, height] = screen.size();
      if (Status s = renderer_->resize(width, height); !s) return s;
      if (Status s = move_scene(options_.light_is_live() || !options_.frames); !s) return s;
      follow_tracking();
      SceneCamera camera = camera_.camera;
      camera.aspect = 0;  // the screen's own
      if (Status s = render(camera); !s) return s;
      renderer_->present();
      if (Status s = screen.show(); !s) return s;
    }
    return finish();
  }

  Status run_window(Window& window) {
    auto overlay = Overlay::create();
    if (!overlay) return overlay.error();
    auto rate_time = Clock::now();
    int shown = 0;
    while (!over(options_.frames) && !window.closed()) {
      const auto fresh = source_.update(frame_, std::chrono::milliseconds(0));
      if (!fresh) return fresh.error();
      const bool tracked = follow_tracking();
      const bool changed = window.take_changed() || tracked;
      const auto [width, height] = window.size();
      const bool moves = scene_.rig.moves() || lamps_.move();
      const bool draw =
          width > 0 && height > 0 && (*fresh || changed || moves || options_.frames.has_value());
      if (draw) {
        if (Status s = renderer_->resize(width, height); !s) return s;
        if (Status s = move_scene(options_.light_is_live() || !options_.frames); !s) return s;
        if (moves || tracked) window.follow(camera_.camera);
        if (Status s = apply(window); !s) return s;
        if (Status s = render(window.camera()); !s) return s;
        ++shown;
      }
      const bool over_it = window.take_overlay_changed() && frame_ > 0 && window.size() == picture_size();
      // Numbers change without a new picture: so does the age of light that stopped.
      const double rate_s = seconds_since(rate_time);
      const bool tick = rate_s >= 0.5 && frame_ > 0 && window.size() == picture_size();
      if (draw || over_it || tick)
        if (Status s = show(window, *overlay); !s) return s;
      if (frame_ > 0 && window.take_screenshot())
        if (Status s = save_screenshot(); !s) say(s.error().message);
      window.poll(draw ? 0 : 0.01);
      if (rate_s >= 0.5) {
        fps_ = shown / rate_s;
        rate_time = Clock::now();
        shown = 0;
        window.set_title(title_text(numbers()));
      }
    }
    return finish();
  }

 private:
  // Brings what is animated to the time of the frame that comes: its number's, or the clock's.
  Status move_scene(bool by_clock) {
    if (!scene_.rig.moves() && !lamps_.move()) return {};
    const double time_s = by_clock ? seconds_since(start_) : frame_ / options_.scene_rate_hz;
    if (Status s = motion_.move_to(time_s); !s)
      return Error{s.error().kind, options_.scene.string() + ": " + s.error().message};
    renderer_->move(scene_, motion_.moved());
    if (camera_.of_scene) camera_.camera = scene_.cameras[*camera_.of_scene];
    return lamps_.move() ? place_lamps() : Status();
  }

  Status place_lamps() {
    if (lamps_.empty()) return {};
    return renderer_->set_lamps(lamps_.place(motion_.pose()));
  }

  Status check_driver() const {
    const int side = Renderer::size_limit();
    if (options_.width > side || options_.height > side)
      return Error{ErrorKind::usage, "--size: this driver allows 1 to " + std::to_string(side) + " a side"};
    if (options_.shadow_size > ShadowAtlas::side_limit())
      return Error{ErrorKind::usage,
                   "--shadow-size: this driver allows 16 to " + std::to_string(ShadowAtlas::side_limit())};
    return {};
  }

  [[nodiscard]] bool over(std::optional<int> frames) const {
    return stop_ || (frames && frame_ >= *frames) ||
           (options_.seconds && seconds_since(start_) >= *options_.seconds);
  }

  // The camera as a tracker has it, where there is one; true where it moved.
  bool follow_tracking() {
    if (tracking_ == nullptr || !tracking_->update()) return false;
    camera_.camera = tracked_camera(*tracking_->camera(), camera_.camera);
    camera_.of_scene.reset();
    return true;
  }

  // Balls a fifth of the picture high, side by side; too small a picture has none.
  Status show_probe(const SceneCamera& camera) {
    if (!show_probe_) return {};
    const int diameter = std::min(renderer_->height() / 5, renderer_->width() / 3);
    const int margin = diameter / 8;
    if (diameter < 8) return {};
    if (Status s = renderer_->lay_over(grey_ball(source_.lights(), camera.world_from_camera, diameter),
                                       margin, margin);
        !s)
      return s;
    if (source_.environment() == nullptr) return {};
    return renderer_->lay_over(mirror_ball(*source_.environment(), source_.environment_turn_rad(),
                                           camera.world_from_camera, diameter),
                               2 * margin + diameter, margin);
  }

  Status show_plate() {
    if (!plates_->plate().remark.empty()) say(plates_->plate().remark);
    return renderer_->set_plate(plates_->plate(), plate_white_cd_m2_.value_or(1));
  }

  Status show_newest_field() {
    const auto another = shown_field_.update(source_, scene_, *renderer_);
    if (!another) return another.error();
    if (*another) statistics_.field = field_statistics(*renderer_);
    return {};
  }

  // A graded plate tells no radiance: unless told, it counts as exposed for the first light that has power.
  bool meter_plate() {
    if (plate_white_cd_m2_ || !plates_->plate().display_referred) return false;
    const Vec3d place = renderer_->object_bounds().centre.cast<double>();
    const float white = (source_.field() != nullptr ? white_floor_cd_m2(*source_.field(), place)
                                                    : white_floor_cd_m2(source_.lights())) +
                        white_floor_cd_m2(lamps_.lamps(), place);
    if (!(white > 0)) return false;
    plate_white_cd_m2_ = white;
    say(plate_white_text(options_.plate, white));
    return true;
  }

  Status render(const SceneCamera& camera) {
    if (plates_ != nullptr) {
      const auto another = plates_->update(frame_);
      if (!another) return another.error();
      const bool metered = meter_plate();
      if (*another || metered)
        if (Status s = show_plate(); !s) return s;
    }
    if (options_.background_environment && source_.environment_version() != shown_environment_) {
      renderer_->set_environment(source_.environment());
      shown_environment_ = source_.environment_version();
    }
    if (Status s = show_newest_field(); !s) return s;
    Statistics::Frame times;
    const auto start = Clock::now();
    const double cpu_start = cpu_ms();
    // Frames of a sequence are 1/25 s apart, live ones as far as they are.
    const double dt_s = options_.light_is_live() ? seconds_since(last_frame_) : 0.04;
    last_frame_ = start;
    const LightSet& lights = budget_.choose(source_.lights());
    if (budget_.lacks_prediction() && !said_no_prediction_) {
      say("--max-error: these lights carry no prediction of their error (method best does); all are taken");
      said_no_prediction_ = true;
    }
    renderer_->set_shadow_texels(budget_.texels());
    if (Status s = renderer_->render(lights, camera, source_.environment_turn_rad()); !s) return s;
    if (Status s = show_probe(camera); !s) return s;
    renderer_->tone_map(dt_s);
    renderer_->finish();
    if (Status s = renderer_->check(); !s) return s;
    times.ms = last_ms_ = seconds_since(start) * 1e3;
    const auto maps = static_cast<double>(std::max<std::size_t>(renderer_->shadow_maps(), 1));
    budget_.frame_took(last_ms_, static_cast<double>(renderer_->shadow_maps_drawn()) / maps);
    times.cpu_ms = cpu_ms() - cpu_start;
    times.passes = renderer_->pass_times();
    if (!options_.stats.empty()) statistics_.frames.push_back(times);
    statistics_.lights =
        renderer_->field() != nullptr ? renderer_->field()->lights_with_power() : lights.lights.size();
    statistics_.predicted_error = lights.lights.empty() ? 0 : lights.lights.back().predicted_error;
    statistics_.shadow_maps = renderer_->shadow_maps();
    if (!lamps_.empty()) statistics_.lamps = renderer_->lamps().counts();
    if (options_.target_fps) statistics_.chosen = {budget_.texels(), budget_.expected_error()};
    const int number = frame_++;
    return write(number, true);
  }

  Status write(int number, bool numbered) {
    for (const FrameName& name : options_.outputs) {
      if (name.numbered != numbered) continue;
      const Status written = name.format == FrameName::Format::exr
                                 ? write_exr(name.file(number), renderer_->radiance())
                                 : write_png(name.file(number), renderer_->display());
      if (!written) return written;
    }
    return {};
  }

  Status finish() {
    if (frame_ > 0)
      if (Status s = write(frame_ - 1, false); !s) return s;
    if (statistics_.field) statistics_.field->update_ms = shown_field_.update_ms();
    if (!options_.stats.empty()) return write_file_atomically(options_.stats, statistics_.json());
    return {};
  }

  [[nodiscard]] std::pair<int, int> picture_size() const { return {renderer_->width(), renderer_->height()}; }

  // The picture that is there, and the overlay.
  Status show(Window& window, Overlay& overlay) const {
    renderer_->present();
    overlay.draw(overlay_content(window), renderer_->width(), renderer_->height());
    return window.show();
  }

  // What keys of the window switched.
  Status apply(Window& window) {
    show_probe_ = options_.probe != window.switches().probe;
    if (const double stops = window.take_exposure_steps(); stops != 0) {
      look_.exposure_ev100 = renderer_->exposure_ev100() - stops;
      renderer_->set_look(look_);
    }
    if (Status s = renderer_->set_light_lists(options_.light_lists != window.switches().lists_the_other_way);
        !s)
      return s;
    return renderer_->set_shadows(window.switches().shadows);
  }

  [[nodiscard]] Overlay::Content overlay_content(const Window& window) const {
    Overlay::Content content;
    const WindowSwitches& on = window.switches();
    if (on.numbers) content.numbers = overlay_text(numbers());
    if (on.help) content.help = Window::help_lines();
    if (!on.dome) return content;
    Sphere dome = renderer_->object_bounds();
    dome.radius *= 1.5f;  // clear of the objects
    const int width = renderer_->width();
    const int height = renderer_->height();
    const View view = make_view(window.camera(), width, height);
    content.markers = dome_markers(budget_.chosen().lights, dome, view, width, height);
    content.lines = dome_lines(dome, view, width, height);
    return content;
  }

  Status save_screenshot() const {
    const auto names = write_screenshot(".", renderer_->display(), renderer_->radiance());
    if (!names) return names.error();
    say("wrote " + *names);
    return {};
  }

  [[nodiscard]] ViewNumbers numbers() const {
    ViewNumbers n;
    n.fps = fps_;
    n.frame_ms = last_ms_;
    n.lights = statistics_.lights;
    n.shadow_maps = statistics_.shadow_maps;
    n.shadow_size = static_cast<int>(options_.shadow_size * std::sqrt(budget_.texels()));
    n.light_arrived = source_.ready();
    n.light_age = source_.age();
    n.predicted_error = statistics_.predicted_error;
    if (options_.target_fps) n.expected_error = budget_.expected_error();
    n.ev100 = renderer_->exposure_ev100();
    n.ev_by_hand = look_.exposure_ev100.has_value();
    return n;
  }

  const Options& options_;
  const std::atomic<bool>& stop_;
  Scene& scene_;
  SceneMotion motion_;
  ChosenCamera camera_;
  LightSource& source_;
  ShownLamps& lamps_;
  PlateSource* plates_;
  TrackingStream* tracking_;
  std::optional<Renderer> renderer_;
  Statistics statistics_;
  ShownField shown_field_;
  LightBudget budget_;
  bool said_no_prediction_ = false;
  Look look_;
  bool show_probe_ = false;
  std::optional<float> plate_white_cd_m2_;
  double fps_ = 0;
  double last_ms_ = 0;
  int frame_ = 0;
  int shown_environment_ = 0;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_frame_ = Clock::now();
};

}  // namespace

Status run_session(const Options& chosen, const std::atomic<bool>& stop) {
  Options options = chosen;
  if (Status s = check_outputs(options); !s) return s;
  auto scene = read_gltf(options.scene, options.animation);
  if (!scene) return scene.error();
  if (scene->triangles() > kManyTriangles)
    say(options.scene.string() + ": " + std::to_string(scene->triangles()) +
        " triangles; simpler ones for their shadows are looked for, about five seconds a million");
  auto camera = choose_camera(*scene, options);
  if (!camera) return camera.error();
  auto source = open_lights(options);
  if (!source) return source.error();
  auto lamps = ShownLamps::open(options.luminaires, *scene);
  if (!lamps) return lamps.error();

  std::optional<PlateSource> plates;
  if (!options.plate.empty()) {
    auto opened = PlateSource::open(options.plate, options.plate_graded);
    if (!opened) return opened.error();
    plates.emplace(std::move(opened).value());
    if (!options.size_given) {
      options.width = plates->plate().width;
      options.height = plates->plate().height;
    }
  }

  std::optional<TrackingStream> tracking;
  if (options.tracking) {
    auto opened = TrackingStream::open(*options.tracking);
    if (!opened) return opened.error();
    tracking.emplace(std::move(opened).value());
  }

  // Made after the context and gone before it.
  const auto run = [&](Window* window, KmsScreen* screen) -> Status {
    Session session(options, stop, *scene, *camera, **source, *lamps, plates ? &*plates : nullptr,
                    tracking ? &*tracking : nullptr);
    if (Status s = session.prepare(); !s) return s;
    // Once all of it is known to work: a refusal is one line.
    for (const std::string& remark : remarks_on(*scene, *camera, **source, options)) say(remark);
    session.say_remarks();
    if (screen != nullptr) return session.run_screen(*screen);
    return window != nullptr ? session.run_window(*window) : session.run_off_screen();
  };
  const bool has_purpose =
      !options.outputs.empty() || options.frames || options.seconds || !options.stats.empty();
  if (options.screen) {
    auto screen = KmsScreen::open();
    if (!screen) return screen.error();
    return run(nullptr, screen->get());
  }
  if (!options.headless && has_display()) {
    auto window = Window::open(options.width, options.height, Orbit(camera->camera, *scene));
    if (window) return run(window->get(), nullptr);
    if (!has_purpose) return window.error();
    say(window.error().message + "; rendering off-screen");
  } else if (!options.headless && !has_purpose) {
    return Error{
        ErrorKind::failed,
        "no display for a window; --screen takes this machine's own, --headless with --out, --frames or "
        "--seconds renders without"};
  }
  auto context = EglContext::create();
  if (!context) return context.error();
  return run(nullptr, nullptr);
}

}  // namespace lightwell::render
