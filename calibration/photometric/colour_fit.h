// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lighting/response.h"
#include "lighting/result.h"

namespace lightwell::calibration {

// A patch of a colour chart: what the camera gave (linear, after its response), and its linear Rec. 709 radiance scaled
// so that Y is luminance in cd/m².
struct ColourPatch {
  std::string name;
  Eigen::Vector3d camera, rec709;
  bool check = false;  // not fitted
};

struct ColourFit {
  Eigen::Matrix3d rec709_from_camera = Eigen::Matrix3d::Identity();
  std::string white;     // the patch that is kept exactly
  std::string rejected;  // the patch left out because the others agree without it; empty: none
  struct Residual {
    std::string name;
    bool check = false;
    Eigen::Vector3d error;       // rec709, relative to the patch's luminance
    double luminance_error = 0;  // relative
  };
  std::vector<Residual> residuals;
  double rms_error = 0;  // of the components of error, over the fitted patches
};

// Columns code_r, code_g, code_b (through `response`) or camera_r, camera_g, camera_b (linear); X, Y, Z (D65 white,
// Y in cd/m²) or rec709_r, rec709_g, rec709_b; [name], [use = fit or check]. bad_input: columns missing, values not
// numbers, clipped codes, patches without light.
Result<std::vector<ColourPatch>> read_chart(const std::filesystem::path& file, const Response& response);

// The 3×3 that minimises Σ |M camera − rec709|² / Y² and maps white exactly: the patch named so (its name begins with
// "white"), else the brightest of the least colourful. One patch that contradicts all others is left out. bad_input:
// fewer than 4 patches, camera colours in a plane, a white ten times brighter or darker than the response says, errors
// above a quarter of the luminance.
Result<ColourFit> fit_colour(const std::vector<ColourPatch>& patches, const std::string& name_for_errors);

nlohmann::ordered_json report_to_json(const ColourFit& fit);

}  // namespace lightwell::calibration
