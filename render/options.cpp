// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/options.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>

#include "interface/dds_domain.h"
#include "interface/option_range.h"
#include "interface/printable.h"
#include "interface/same_file.h"
#include "lighting/field/main_lights.h"

namespace lightwell::render {
namespace {

constexpr const char* kExample =
    "Example: lightwell-render --scene stage.gltf --environment studio.exr --headless --out relit.png\n"
    "\n"
    "An EXR holds linear radiance in the light's own units, row 0 at the top, one sample at each pixel's "
    "centre; a PNG\n"
    "what the tone mapping makes of it. Frame numbers start at 0; a name without a number holds the last "
    "frame.\n"
    "Every light has a shadow: where there are more lights than --shadow-maps, the set is folded to that "
    "many first.\n"
    "predicted_error in --stats: of shadows, where the lights carry one (method best).";

// "640x480", each side 1 to 16384; the driver may allow less.
Result<std::pair<int, int>> parse_size(const std::string& text) {
  int width = 0;
  int height = 0;
  int used = 0;
  const int found = std::sscanf(text.c_str(), "%5dx%5d%n", &width, &height, &used);
  if (found != 2 || static_cast<std::size_t>(used) != text.size() || width < 1 || height < 1 ||
      width > 16384 || height > 16384)
    return Error{ErrorKind::usage, "--size " + text + ": must be WIDTHxHEIGHT, each 1 to 16384"};
  return std::pair(width, height);
}

int complain(const std::string& message) {
  std::fprintf(stderr, "lightwell-render: %s\n", printable(message).c_str());
  return static_cast<int>(ErrorKind::usage);
}

}  // namespace

Parsed parse_options(int argc, const char* const* argv) {
  Options options;
  std::string size = "640x480";
  std::string background = "none";
  std::string tone_map = "reinhard";
  std::string method = std::string(name(options.method));
  std::vector<std::string> outputs;
  CLI::App app{"Renders a scene under measured light, with its shadows: off-screen or in a window",
               "lightwell-render"};
  app.footer(kExample);
  app.set_version_flag("--version", "lightwell 0.1.0");
  app.add_option("--scene", options.scene, "glTF 2.0 scene, .gltf or .glb")->required();
  auto* live = app.add_flag("--live", options.live, "light from a running daemon, over DDS");
  auto* domain = app.add_option("--domain", options.domain, "DDS domain of --live and --field live")
                     ->check(whole_numbers(0, kMaxDdsDomain));
  auto* interface =
      app.add_option("--interface", options.interface, "network interface of --live and --field live")
          ->capture_default_str();
  app.add_option("--light-set", options.light_set, "light from a lights.json")->excludes(live);
  auto* environment = app.add_option("--environment", options.environment,
                                     "light from a latitude–longitude image, EXR or Radiance HDR")
                          ->excludes(live)
                          ->excludes("--light-set");
  auto* field = app.add_option("--field", options.field,
                               "light that differs from place to place: a file of lightwell field build "
                               "(OpenVDB), or live: of a "
                               "running lightwell field live, over DDS")
                    ->excludes(live)
                    ->excludes("--light-set")
                    ->excludes(environment);
  app.add_option("--field-shadows", options.field_shadows,
                 "so many main lights of the field cast shadows; 0: none does")
      ->check(whole_numbers(0, kMostMainLights))
      ->capture_default_str()
      ->needs(field);
  auto* balls =
      app.add_option_function<std::string>(
             "--field-balls",
             [&](const std::string& count) {
               options.field_balls.emplace();
               options.field_balls->most = count == "all" ? 0 : std::stoi(count);
             },
             "small balls that show the field's light: so many along each axis (2 to 512), or all: one "
             "at every grid point")
          ->check(CLI::IsMember({"all"}) | whole_numbers(2, 512))
          ->needs(field);
  std::string ball_look = "matt";
  app.add_option("--field-ball-look", ball_look,
                 "white and matt, or mirror: as sharp as the field's degree is")
      ->check(CLI::IsMember({"matt", "mirror"}))
      ->capture_default_str()
      ->needs(balls);
  LuminaireArguments luminaires;
  luminaires.add_to(app);
  app.add_option("--lights", options.lights, "lights to make of the environment")
      ->check(whole_numbers(1, kMostLights))
      ->capture_default_str()
      ->needs(environment);
  app.add_option("--method", method, "how to make them: " + method_names())
      ->capture_default_str()
      ->needs(environment);
  bool hemisphere = false;
  bool sphere = false;
  app.add_flag("--hemisphere", hemisphere, "of its upper half, what the probe sees (default)")
      ->needs(environment);
  app.add_flag("--sphere", sphere, "of all of it")->needs(environment)->excludes("--hemisphere");
  app.add_option("--spin", options.spin_deg,
                 "turns the environment about +Y by so many degrees more every frame")
      ->check(numbers_from(-360, 360, "-360 to 360 degrees"))
      ->needs(environment);
  app.add_option("--shadow-maps", options.shadow_maps,
                 "most lights to render, each with its map (default: all; live 72)")
      ->check(whole_numbers(1, 100000))
      ->excludes(field);
  app.add_option("--target-fps", options.target_fps,
                 "holds this frame rate by fewer of the lights, the least urgent left out first, and smaller "
                 "shadow maps")
      ->check(numbers_above_0_to(1000, "above 0 to 1000 frames a second"))
      ->excludes(field);
  app.add_option("--max-error", options.max_error,
                 "takes the fewest lights whose predicted shadow error (relative) is below this; method best "
                 "predicts it")
      ->check(numbers_above_0_to(10, "above 0 to 10"))
      ->excludes(field);
  app.add_option("--shadow-size", options.shadow_size, "texels a side of a shadow map")
      ->check(whole_numbers(16, 4096))
      ->capture_default_str();
  app.add_option_function<std::string>(
         "--shadow-edges", [&](const std::string& edges) { options.soft_edges = edges == "soft"; },
         "soft: as wide as what each light stands for makes them; hard: a point's (default)")
      ->check(CLI::IsMember({"soft", "hard"}));
  app.add_option(
         "--interleave", options.interleave,
         "squares of so many pixels a side share the weak lights among them: 1 (each pixel takes all), 2, 4")
      ->check(CLI::IsMember({1, 2, 4}))
      ->capture_default_str();
  app.add_option_function<std::string>(
         "--light-lists", [&](const std::string& lists) { options.light_lists = lists == "on"; },
         "on: a pixel takes the lights that its normal's region lists; off: looks at all (default); the same "
         "picture")
      ->check(CLI::IsMember({"on", "off"}));
  app.add_option("--size", size, "picture, WxH")->capture_default_str();
  app.add_option("--camera", options.camera,
                 "camera of the scene, by its name or its node's (default: the first)");
  app.add_option("--animation", options.animation,
                 "animation of the scene, by its name (default: the first)");
  app.add_option(
         "--scene-rate", options.scene_rate_hz,
         "frames a second of the scene's time; live and in a window without --frames it is the clock's")
      ->check(numbers_from(1e-3, 1e6, "0.001 to 1000000 Hz"))
      ->capture_default_str();
  app.add_option("--samples", options.samples, "samples a pixel; 4 and more antialias")
      ->check(whole_numbers(1, 1024))
      ->capture_default_str();
  app.add_option("--background", background,
                 "behind the scene: none (black, alpha 0), the measured environment, or a plate: EXR, PNG, "
                 "JPEG or a numbered sequence; what only receives shadows shows the plate, darkened by them")
      ->capture_default_str();
  app.add_option("--plate-white", options.plate_white_cd_m2, "radiance that the plate's value 1 stands for")
      ->check(numbers_above_0_to(1e9, "above 0 to 1e9 cd/m²"));
  std::string plate_values;
  app.add_option(
         "--plate-values", plate_values,
         "what they are: graded for a display, whose look stays (PNG and JPEG unless told), or radiance, "
         "toned as the objects are (EXR unless told)")
      ->check(CLI::IsMember({"graded", "radiance"}));
  std::string tracking;
  std::optional<double> focal_mm_per_unit;
  std::optional<double> sensor_height_mm;
  app.add_option("--tracking", tracking,
                 "camera pose from a tracker over UDP: opentrackio:ADDRESS:PORT or freed:ADDRESS:PORT, this "
                 "machine's address or a multicast group; stage x, y, z is the scene's x, z, -y");
  std::optional<int> tracked_camera;
  app.add_option(
         "--tracking-camera", tracked_camera,
         "which camera to follow where the port hears several: FreeD's id, OpenTrackIO's sourceNumber "
         "[the first]")
      ->check(whole_numbers(0, kMostTrackedCamera))
      ->needs("--tracking");
  app.add_option("--sensor-height", sensor_height_mm,
                 "of the tracked camera, for its field of view, where the stream does not tell it")
      ->check(numbers_above_0_to(1e4, "above 0 to 10000 mm"))
      ->needs("--tracking");
  app.add_option("--freed-focal", focal_mm_per_unit, "focal length that a unit of FreeD's zoom stands for")
      ->check(numbers_above_0_to(1e3, "above 0 to 1000 mm"))
      ->needs("--tracking")
      ->needs("--sensor-height");
  app.add_flag("--probe", options.probe,
               "a grey ball (Lambertian, albedo 0.18) under the lights and a mirror ball of the environment, "
               "in the lower left corner")
      ->excludes(field);
  app.add_option("--tonemap", tone_map, "for window and PNG: reinhard, or none (clamped)")
      ->check(CLI::IsMember({"reinhard", "none"}))
      ->capture_default_str();
  app.add_option("--exposure", options.look.exposure_ev100,
                 "of window and PNG, EV at ISO 100, instead of what the picture asks for")
      ->check(numbers_from(-20, 40, "-20 to 40 EV"));
  std::string display = "srgb";
  std::string false_colour = "none";
  app.add_option("--display", display, "transfer function of window and PNG: srgb, rec709, linear")
      ->check(CLI::IsMember({"srgb", "rec709", "linear"}))
      ->capture_default_str();
  app.add_option("--false-colour,--false-color", false_colour,
                 "window and PNG show luminance as colours, with a legend: cd (cd/m²), stops (from middle "
                 "grey at the exposure)")
      ->check(CLI::IsMember({"none", "cd", "stops"}))
      ->capture_default_str();
  app.add_flag("--headless", options.headless, "no window");
  app.add_flag("--screen", options.screen,
               "full screen on this machine's own screen where there is no desktop (KMS)")
      ->excludes("--headless")
      ->excludes("--size");
  app.add_option("--frames", options.frames, "end after this many frames (off-screen default: 1, live: none)")
      ->check(whole_numbers(1, 1000000000));
  app.add_option("--seconds", options.seconds, "end after this time")
      ->check(numbers_from(0, 1e9, "0 to 1e9 seconds"));
  app.add_option("--out", outputs, "pictures, NAME.exr, NAME.png or NAME_%04d.exr; may be given again");
  app.add_option("--stats", options.stats, "times and counts of the run, as JSON");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return {std::nullopt, app.exit(error)};
    return {std::nullopt, complain(error.what())};
  }
  const auto lamps = luminaires.lamps();
  if (!lamps) return {std::nullopt, complain(lamps.error().message)};
  options.luminaires = *lamps;
  options.luminaire_error = luminaires.max_error();
  if (!options.live && options.light_set.empty() && options.environment.empty() && options.field.empty() &&
      options.luminaires.empty())
    return {std::nullopt, complain("one of --live, --environment, --light-set, --field and --luminaire must "
                                   "say where the light comes from")};
  options.live_field = options.field == "live";
  for (const auto* option : {domain, interface})
    if (!option->empty() && !options.light_is_live())
      return {std::nullopt, complain(option->get_name() + ": only --live and --field live need it")};
  const auto chosen = method_from_name(method);
  if (!chosen) return {std::nullopt, complain("--method " + method + ": must be one of " + method_names())};
  options.method = *chosen;
  options.coverage = sphere ? Coverage::sphere : Coverage::hemisphere;
  const auto parsed_size = parse_size(size);
  if (!parsed_size) return {std::nullopt, complain(parsed_size.error().message)};
  std::tie(options.width, options.height) = *parsed_size;
  options.size_given = !app.get_option("--size")->empty();
  options.background_environment = background == "environment";
  if (!options.background_environment && background != "none") options.plate = background;
  if (background.empty())
    return {std::nullopt, complain("--background '': must be none, environment or a picture's name")};
  if (options.plate_white_cd_m2 && options.plate.empty())
    return {std::nullopt, complain("--plate-white: there is no plate; --background names one")};
  if (!plate_values.empty()) {
    if (options.plate.empty())
      return {std::nullopt, complain("--plate-values: there is no plate; --background names one")};
    options.plate_graded = plate_values == "graded";
  }
  for (const std::string& pattern : outputs) {
    const auto name = FrameName::parse(pattern);
    if (!name) return {std::nullopt, complain(name.error().message)};
    options.outputs.push_back(*name);
  }
  outputs.push_back(options.stats.string());
  for (const std::string& output : outputs) {
    if (const Status other = check_output_is_no_input(
            output, {options.scene, options.environment, options.light_set,
                     options.live_field ? std::filesystem::path() : options.field, options.plate});
        !other)
      return {std::nullopt, complain(other.error().message)};
    for (const LuminaireOptions& lamp : options.luminaires)
      if (const Status other = check_output_is_no_input(output, {lamp.file}); !other)
        return {std::nullopt, complain(other.error().message)};
  }
  if (options.background_environment && !options.light_set.empty())
    return {std::nullopt,
            complain("--background environment: a light set has no picture of its environment")};
  if (options.background_environment && !options.has_lights())
    return {std::nullopt, complain("--background environment: a lamp has no picture of its environment")};
  if (options.background_environment && !options.field.empty())
    return {std::nullopt, complain("--background environment: a field has no picture of its environment")};
  if (options.field_balls) options.field_balls->mirror = ball_look == "mirror";
  options.look.operation = tone_map == "none" ? ToneMap::none : ToneMap::reinhard;
  options.look.display = display == "rec709"   ? Display::rec709
                         : display == "linear" ? Display::linear
                                               : Display::srgb;
  options.look.false_colour = false_colour == "cd"      ? FalseColour::luminance
                              : false_colour == "stops" ? FalseColour::stops
                                                        : FalseColour::none;
  if (!tracking.empty()) {
    const auto parsed = parse_tracking(tracking);
    if (!parsed) return {std::nullopt, complain(parsed.error().message)};
    options.tracking = *parsed;
    options.tracking->camera = tracked_camera;
    options.tracking->freed_mm_per_unit = focal_mm_per_unit;
    options.tracking->sensor_height_mm = sensor_height_mm;
    if (focal_mm_per_unit && parsed->protocol != TrackingProtocol::freed)
      return {std::nullopt, complain("--freed-focal: only FreeD's zoom needs it")};
  }
  return {options, 0};
}

}  // namespace lightwell::render
