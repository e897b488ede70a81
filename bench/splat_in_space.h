// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lighting/field/direction_bins.h"
#include "lighting/field/light_field.h"

namespace lightwell::bench {

// The algorithm of Löw et al. 2009 as they describe it, one thread: for each direction every probe's ray is projected both
// ways through the volume, every grid point within the kernel (lighting/field/gaussian_splat.h) takes its radiance, points
// that none reaches are repaired by a three-dimensional pull–push, and each point's harmonics are summed.
class SplatInSpace {
 public:
  SplatInSpace(const FieldGrid& grid, int degree);
  // radiance: of each position; harmonics: [harmonic_count(degree)], times the solid angle.
  void add(const MeasuredDirection& direction, std::span<const Vec3d> positions,
           std::span<const Rgb> radiance, const Eigen::VectorXf& harmonics);
  [[nodiscard]] const LightField& field() const { return field_; }

 private:
  struct Level {
    std::array<int, 3> size;
    std::vector<Rgb> radiance;
    std::vector<float> weight;
    [[nodiscard]] std::size_t at(int x, int y, int z) const {
      return static_cast<std::size_t>((z * size[1] + y) * size[0] + x);
    }
  };
  void project(const Vec3d& through, const Vec3d& along, const Rgb& radiance);
  void repair();
  static Level half_of(const Level& fine);
  static bool interpolate(const Level& level, const Vec3d& at, Rgb& value);
  LightField field_;
  Level volume_;
};

}  // namespace lightwell::bench
