// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "calibration/photometric/photograph.h"
#include "lighting/picture_map.h"

// From the merged photographs of a fisheye to a radiance map that the rest of Lightwell reads.
namespace lightwell::calibration {

struct BracketMap {
  PolarMap map;                           // of the whole sphere, a degree a bin, upright by the lens's zenith
  Rgbd total_illuminance;                 // lux summed over directions
  double facing_lux = 0, upward_lux = 0;  // on a surface that faces what the lens faces, that is level
};

// radiance: the merged photographs; photograph: one of them, as it was read; shrink: by what merge_brackets shrank.
// bad_input: the lens or the flat field is of pictures of another size; a flat field with offsets or gains of pixels,
// which photographs, developed by their camera, cannot be corrected for.
Result<BracketMap> bracket_map(const RadiancePicture& radiance, const Photograph& photograph, int shrink,
                               const Lens& lens, const FlatField& flat);

nlohmann::ordered_json to_json(const BracketMap& map);

}  // namespace lightwell::calibration
