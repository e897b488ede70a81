// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "lighting/calibration.h"
#include "lighting/lat_long_image.h"
#include "lighting/result.h"
#include "lighting/vector.h"

namespace lightwell::calibration {

// What a lux meter reads that faces toward: Σ luminance × solid angle × cosine over its hemisphere. cosine false: a
// photodiode that counts every direction of that hemisphere alike.
struct Meter {
  Vec3d toward = Vec3d::UnitY();  // unit
  bool cosine = true;
};

double illuminance_lux(const LatLongImage& image, const Meter& meter);

// The part of the meter's hemisphere, as the meter weighs it, where the map is above 0: a map has nothing else to tell
// black from never seen.
double lit_part(const LatLongImage& image, const Meter& meter);

struct RecordedIlluminance {
  double lux = 0;        // mean over the frames
  double sigma_lux = 0;  // standard deviation over the frames
  std::uint64_t frames = 0;
  std::uint64_t clipped = 0;  // most clipped pixels of a frame: the light is more than measured
  double darkness_lux = 0;    // of a code above darkness all over the field: less is no light but noise
  double measured_part = 1;   // of the meter's hemisphere, as the meter weighs it; of a map: lit_part
};
// Develops every frame. bad_input: not a take, damaged, or of another size or depth than the calibration's.
Result<RecordedIlluminance> recorded_illuminance(const std::filesystem::path& recording,
                                                 const Calibration& calibration, const Meter& meter);

}  // namespace lightwell::calibration
