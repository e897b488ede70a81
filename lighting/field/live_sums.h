// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "lighting/field/light_field.h"
#include "lighting/field/ray_kriging.h"

namespace lightwell {

// From what few probes see in each of a fixed set of directions to a small field: on the plane across the direction, then
// at every grid point, then as harmonics. What a frame needs stands ready: nothing is allocated while it runs.
class LiveSums {
 public:
  // harmonics: of each direction, ∫ Y_lm over what it stands for. [harmonic_count(degree)][directions]
  // directions: at least one; all of the same probes.
  LiveSums(const FieldGrid& grid, int degree, std::span<const RayKriging> directions,
           const Eigen::MatrixXd& harmonics);

  // radiance: [directions][3][probes]; adds its light to the harmonics of the field's points, one of this grid and degree.
  void add(std::span<const float> radiance, LightField& field);

 private:
  struct Direction {
    ShearPlane plane;
    int width, pixels;           // of the plane, rounded up
    std::vector<float> weights;  // [probes][pixels]
    std::size_t image;           // where its first pixel stands
  };
  void look_up_slab(const Direction& direction, int z, float* out) const;
  FieldGrid grid_;
  int degree_;
  std::size_t probes_;
  std::vector<Direction> directions_;
  std::vector<float> harmonics_;  // [directions][harmonics]
  std::vector<float> images_;     // a direction's R, G, B pixels
  std::vector<float> slab_;       // [directions of a batch][R, G, B points]
  std::vector<float> sums_;       // [harmonics][R, G, B points], rounded up
};

}  // namespace lightwell
