// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lighting/vector.h"

namespace lightwell::render {

struct Sphere {
  Vec3f centre = Vec3f::Zero();
  float radius = 0;  // 0: empty
};

// Contains every point, and is within 1 % of the smallest that does.
// source: Bădoiu and Clarkson 2003
Sphere bounding_sphere(std::span<const Vec3f> points);

}  // namespace lightwell::render
