// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/bracket_map.h"

#include "calibration/photometric/illuminance_check.h"
#include "lighting/orientation.h"

namespace lightwell::calibration {
namespace {

std::string size_text(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

Status check_inputs(const Photograph& photograph, const Lens& lens, const FlatField& flat) {
  if (lens.image_size != std::array<int, 2>{photograph.full_width, photograph.full_height})
    return Error{ErrorKind::bad_input,
                 "lens.image_size = " + size_text(lens.image_size[0], lens.image_size[1]) +
                     ": allowed that of the photographs, " +
                     size_text(photograph.full_width, photograph.full_height)};
  if (!flat.offset_codes.empty() || !flat.gain.empty())
    return Error{ErrorKind::bad_input,
                 std::string(flat.gain.empty() ? "flat.offset_codes" : "flat.gain") +
                     " is there: allowed vignetting alone, for a camera's photographs no longer have the "
                     "sensor's codes"};
  return check(flat, lens);
}

}  // namespace

Result<BracketMap> bracket_map(const RadiancePicture& radiance, const Photograph& photograph, int shrink,
                               const Lens& lens, const FlatField& flat) {
  if (const Status status = check_inputs(photograph, lens, flat); !status) return status.error();
  FlatField vignetting;
  vignetting.vignetting = flat.vignetting;
  auto map = polar_map_from_picture(radiance, shrunk(lens, shrink), vignetting, {180, 360, kPi});
  if (!map) return map.error();
  BracketMap out;
  out.map = *std::move(map);
  out.total_illuminance = total_illuminance(out.map);
  const LatLongImage image = lat_long_of_measured(out.map);
  const Vec3d facing = world_from_camera_rotation(lens.zenith) * Vec3d::UnitZ();
  out.facing_lux = illuminance_lux(image, {facing});
  out.upward_lux = illuminance_lux(image, {});
  return out;
}

nlohmann::ordered_json to_json(const BracketMap& map) {
  const Rgbd& total = map.total_illuminance;
  return {{"coverage", map.map.coverage},
          {"total_illuminance", {total[0], total[1], total[2]}},
          {"facing_lux", map.facing_lux},
          {"upward_lux", map.upward_lux},
          {"clipped_pixels", map.map.clipped_pixels}};
}

}  // namespace lightwell::calibration
