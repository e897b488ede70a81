// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/lens_import/projections.h"
#include "lighting/lens.h"
#include "lighting/result.h"

namespace lightwell::calibration {

enum class LensFormat { opencv, kalibr, ocamcalib, mrcal };
std::string_view name(LensFormat format);
std::optional<LensFormat> lens_format(std::string_view name);

// A lens as another program describes it.
struct SourceLens {
  LensFormat format = LensFormat::opencv;
  std::string model;     // in that program's words
  bool assumed = false;  // neither the file nor the user said the model
  std::array<int, 2> image_size = {0, 0};
  Projection project;
  std::optional<Lens> same;  // where the model is ours; without a field
  std::vector<Vec2d>
      valid_region;  // outline in the image inside which the source trusts itself; empty: all of it
};

struct SourceLensOptions {
  std::optional<LensFormat> format;  // none: by the content
  std::string camera = {};           // of a file with several; empty: the only one
  // Of an OpenCV file that names none: fisheye, omnidir. Empty: fisheye is assumed where the image is too wide for a
  // perspective lens.
  std::string model = {};
};

// bad_input names file, field, value and what is allowed: a size that is missing, skew, a wrong number of
// coefficients, numbers that are not finite, a model that is not known or at odds with its numbers. usage: several
// cameras and none chosen, or one that is not there; a model that the file contradicts, or that neither it nor the
// image tells.
Result<SourceLens> read_source_lens(const std::filesystem::path& file, const SourceLensOptions& options);

}  // namespace lightwell::calibration
