// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lighting/flat_field.h"
#include "lighting/lens.h"
#include "lighting/response.h"

namespace lightwell {

// Everything that turns a camera's codes into radiance per direction.
struct Calibration {
  Response response;
  Lens lens;
  FlatField flat;
  Eigen::Matrix3d rec709_from_camera = Eigen::Matrix3d::Identity();  // colour cameras only
  std::string
      id;  // 16 hex digits over the content; travels with every light set (interface/calibration_io.h)
};

}  // namespace lightwell
