// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lighting/field/field_grid.h"
#include "lighting/harmonics.h"

namespace lightwell {

inline constexpr int kMostFieldDegree = 8;

// Incident light at the points of a grid as spherical harmonics of radiance (lighting/harmonics.h), cd/m².
struct LightField {
  FieldGrid grid;
  int degree = 4;  // 1 to kMostFieldDegree
  // [z][harmonic][R, G, B][y][x]: slabs, so that each is one block of memory to those who write it.
  std::vector<float> radiance;
  // [z][y][x]: part of the sphere from which a measured ray passes near the point (kNearCells), 0 to 1. The rest is
  // taken from rays farther away, or dark where no probe looked.
  std::vector<float> confidence;

  [[nodiscard]] std::size_t slab_points() const {
    return static_cast<std::size_t>(grid.size[0]) * static_cast<std::size_t>(grid.size[1]);
  }
  [[nodiscard]] int harmonics() const { return harmonic_count(degree); }
  // One channel of one harmonic of slab z: [y][x].
  [[nodiscard]] const float* plane(int z, int harmonic, int channel) const;
  [[nodiscard]] float* plane(int z, int harmonic, int channel);
};

// A field at one place, by trilinear interpolation between grid points.
struct LightAtPoint {
  Eigen::ArrayX3d radiance;  // [harmonic][RGB]
  double confidence = 0;
};
// world: inside the grid's bounds.
LightAtPoint light_at(const LightField& field, const Vec3d& world);

// Irradiance of a surface with this unit normal, lux: Σ A_l L_lm Y_lm. May be a little below 0 where all light comes
// from one place behind the surface: a degree cuts short what a cosine keeps.
Rgbd irradiance(const LightAtPoint& light, const Vec3d& normal);

}  // namespace lightwell
