// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "bench/pictures/flip.h"
#include "lighting/result.h"
#include "render/picture.h"

namespace lightwell::pictures {

// A picture that others are measured by.
struct Reference {
  int width = 0;
  int height = 0;
  std::vector<Rgb> radiance;       // linear, the light's own units
  std::vector<std::uint8_t> mask;  // 1: counts
};

// Counts every pixel whose eight neighbours all show a surface as it does: the outline against nothing is a matter of
// antialiasing.
Reference reference_of(const render::RadiancePicture& picture);

// Half float EXR, the mask as alpha; read gives what was written to a half's 11 bits.
Status write_reference(const std::filesystem::path& file, const Reference& reference);
// bad_input: missing, not an EXR
Result<Reference> read_reference(const std::filesystem::path& file);

struct PictureError {
  double relative_rmse = 0;  // ‖picture − reference‖ / ‖reference‖ over what counts and RGB, linear
  double bias = 0;           // Σ (picture − reference) / Σ reference
  double flip = 0;           // mean of FLIP, both tone-mapped as below
};
// picture: linear, of the reference's size
PictureError picture_error(const std::vector<Rgb>& picture, const Reference& reference);

// Reinhard's operator (Reinhard et al. 2002, eqs. 1, 2 and 4) with key 0.18, log-average and white point those of the
// reference where it counts, so that both pictures are shown alike.
LinearPicture displayed(const std::vector<Rgb>& radiance, const Reference& as);

// Colours of a picture without alpha.
std::vector<Rgb> colours_of(const render::RadiancePicture& picture);

}  // namespace lightwell::pictures
