// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <nlohmann/json.hpp>

#include "calibration/lens_import/source_lens.h"
#include "lighting/lens.h"
#include "lighting/result.h"

namespace lightwell::calibration {

// Ours less the source's, over directions of the field that the source shows inside its image, equal solid angles
// weighing equally.
struct ConversionError {
  std::size_t directions = 0;
  double rms_px = 0, max_px = 0;
  double rms_deg = 0, max_deg = 0;  // between a direction and where ours puts its pixel
  double max_at_deg = 0;            // angle off axis where max_px is
};

struct LensConversion {
  Lens lens;
  bool exact = false;    // the source's model is ours: its numbers are taken as they are
  int coefficients = 4;  // of a fit: the most that keep the projection growing over the field
  // Angle-axis that turns the source's camera frame into ours, radians. Not 0 where the source's axis and image axes
  // are not the lens's own (mrcal's splines say nothing of either), and a turn halves the error of the fit.
  Vec3d turn = Vec3d::Zero();
  double supported_theta_rad = 0;  // the farthest that the source shows in its image; beyond, extrapolated
  ConversionError error;
};

// Our lens for a source's. Where the models differ: the focal lengths, centre and k1 … k4 whose pixels are nearest the
// source's, by least squares over the field, weighted by solid angle; of two frames of the camera where need be (turn).
// max_theta_rad: how far the field goes; none: to the farthest angle that the source shows in its image (its valid
// region) and up to which its projection grows.
// usage where the lens does not grow as far as max_theta_rad, with the limit; bad_input where the source shows nothing,
// or no lens of ours follows it.
Result<LensConversion> convert_lens(const SourceLens& source, std::optional<double> max_theta_rad);

// A direction of the source's camera frame in ours.
Vec3d turned(const LensConversion& conversion, const Vec3d& direction);

// lens.json of an imported lens: what the spine reads, and "imported" (docs/conventions.md).
nlohmann::ordered_json import_report(const SourceLens& source, const LensConversion& conversion);

}  // namespace lightwell::calibration
