// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lighting/luminaire/bell_basis.h"
#include "lighting/result.h"
#include "lighting/vector.h"

namespace lightwell {

// A rig that measures a lamp (Granier et al. 2003, section 5): the lamp shines through a filter on its sampling plane onto
// a screen, a camera takes a picture of the screen for every position of the lamp. Its folder holds rig.toml,
// positions.csv and the pictures, EXR. docs/user-guide/luminaires.md describes every field.
struct Rig {
  enum class Unit {
    lux,        // illuminance of the screen
    luminance,  // of the screen, cd/m²
    codes,      // of the camera, through its response
    relative,   // linear; an illuminance that was measured elsewhere gives the scale
  };
  enum class Moves {
    lamp,    // filter, screen and camera stay: a place is by how much the lamp was moved
    filter,  // lamp, screen and camera stay: a place is where the filter's middle is
  };
  struct Mark {  // a point of the screen and where a picture shows it; (0,0) is the first pixel's centre
    Vec2d pixel = Vec2d::Zero(), screen_m = Vec2d::Zero();
  };
  struct
      Edges {  // of pictures whose pixels are the screen's: outer corners of the first and of the last pixel
    Vec2d first_m = Vec2d::Zero(), last_m = Vec2d::Zero();
  };
  struct Reference {  // what a lux meter read there, without the filter
    Vec3d at_m = Vec3d::Zero(), toward = Vec3d::UnitZ();
    double lux = 0;
  };
  enum class Part { whole, positive, negative };  // of the filter: what a slide lets through
  struct Picture {
    std::string file, place;           // place: "positions.csv: line 7", for errors
    Vec2d position_m = Vec2d::Zero();  // of the filter's middle, in the lamp's frame
    Part part = Part::whole;
    double exposure_us = 0;  // 0: the response's reference
  };

  std::string name;
  // Sampling plane.
  double spacing_m = 0, z_m = 0;
  BellDual filter = BellDual::finite;
  double peak_transmission = 1;  // of the slides where the filter is greatest
  Moves moves = Moves::lamp;
  // Measurement plane: the screen, (s, t) along the lamp's (x, y) when it stands at (0, 0).
  double distance_m = 0;
  Vec2d low_m = Vec2d::Zero(), high_m = Vec2d::Zero();
  std::array<int, 2> pixels = {1, 1};
  // Camera.
  Unit unit = Unit::lux;
  std::string calibration;  // folder in the rig's; empty: a camera without distortion
  double screen_reflectance = 1;
  std::optional<double>
      saturation;  // value from which a pixel is saturated; of codes the response's clip code too
  double most_saturated = 1e-4, most_negative = 0.05;  // part of the pixels; part of the light
  std::string dark;                                    // picture without the lamp; empty: none
  double dark_exposure_us = 0;
  std::vector<Mark> marks;     // at least four,
  std::optional<Edges> edges;  // or these
  double most_mark_error_px = 2;
  std::optional<Reference> reference;
  std::vector<Picture> pictures;
};

// bad_input: names file, field, value and range; a key that is not known.
Result<Rig> read_rig(const std::filesystem::path& folder);
// rig.toml alone, without the pictures. exposure_us: what pictures have that say none.
Result<Rig> parse_rig(std::string_view text, const std::string& file, double* exposure_us = nullptr);

}  // namespace lightwell
