// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calibration/lens_import/source_lens.h"
#include "interface/json_fields.h"

// One reader a format. All throw FieldFailure.
namespace lightwell::calibration {

// OpenCV's fisheye model (cv::fisheye) and its omnidirectional one (cv::omnidir), under the names that programs usually
// give to camera matrix, coefficients and size. model: as SourceLensOptions
SourceLens opencv_lens(const JsonFields& root, const std::string& model);
// camera: of a file of several, "" for the only one
SourceLens kalibr_lens(const nlohmann::json& root, const std::string& file, const std::string& camera);
SourceLens mrcal_lens(const JsonFields& root);
SourceLens ocamcalib_lens(const std::string& text, const std::string& file);

// Shared checks: a whole number of pixels; a plane with finite numbers and positive focal length.
int image_side(const JsonFields& fields, const std::string& key, double value);
PinholePlane pinhole_plane(const JsonFields& fields, const std::string& key, double fx, double fy, double cx,
                           double cy);

}  // namespace lightwell::calibration
