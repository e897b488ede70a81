// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <memory>

#include "lighting/luminaire/luminaire.h"

namespace lightwell::render {

// A lamp in a scene. Lamps of one file may share it.
struct PlacedLamp {
  std::shared_ptr<const Luminaire> lamp;
  Eigen::Isometry3d world_from_lamp = Eigen::Isometry3d::Identity();
  double dimming = 1;  // times its light; 0: off
};

}  // namespace lightwell::render
