// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "interface/frame_name.h"
#include "lighting/decomposition/decompose.h"
#include "lighting/light_set.h"
#include "render/field_balls.h"
#include "render/look.h"
#include "render/luminaire_options.h"
#include "render/tracking_stream.h"

namespace lightwell::render {

// The command line of lightwell-render, checked.
struct Options {
  std::filesystem::path scene;
  bool live = false;
  int domain = 0;
  std::string interface = "lo";
  std::filesystem::path light_set;
  std::filesystem::path environment;
  std::filesystem::path field;
  bool live_field = false;  // the field comes over DDS
  int field_shadows = 4;    // main lights of a field that cast shadows
  std::optional<FieldBallsOptions> field_balls;
  std::vector<LuminaireOptions> luminaires;
  double luminaire_error = 0.01;  // of taking positions together
  int lights = 72;
  Method method = Method::best;
  Coverage coverage = Coverage::hemisphere;
  double spin_deg = 0;               // of the environment, a frame
  std::optional<double> target_fps;  // held by fewer lights
  std::optional<double> max_error;   // predicted: kept by the fewest lights
  int shadow_maps = 0;               // 0: all lights, live 72
  int shadow_size = 256;
  bool soft_edges = false;
  int interleave = 2;  // pixels a side that share the weak lights; 1: none do
  bool light_lists = false;
  int width = 640;
  int height = 480;
  bool size_given = false;  // else a plate's own
  std::string camera;
  std::string animation;      // empty: the first
  double scene_rate_hz = 25;  // frames of the scene's animation a second
  int samples = 1;
  bool background_environment = false;
  std::string plate;  // picture or numbered sequence; empty: none
  std::optional<float> plate_white_cd_m2;
  std::optional<bool> plate_graded;  // else as its format says
  std::optional<TrackingOptions> tracking;
  bool probe = false;  // grey and mirror ball in a corner
  Look look;
  bool headless = false;
  bool screen = false;  // this machine's own, without a desktop
  std::optional<int> frames;
  std::optional<double> seconds;
  std::vector<FrameName> outputs;
  std::filesystem::path stats;

  // Light other than that of lamps.
  [[nodiscard]] bool has_lights() const {
    return live || !environment.empty() || !light_set.empty() || !field.empty();
  }
  // Light that comes when it comes: frames follow the clock.
  [[nodiscard]] bool light_is_live() const { return live || live_field; }
};

// Options, or the exit code where there is nothing to run (help, wrong usage: said on stderr in one line).
struct Parsed {
  std::optional<Options> options;
  int exit_code = 0;
};
Parsed parse_options(int argc, const char* const* argv);

}  // namespace lightwell::render
