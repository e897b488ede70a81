// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "lighting/field/light_field.h"
#include "lighting/field/shear_plane.h"

namespace lightwell {

// One direction, ready to be added at every grid point.
struct FieldDirection {
  ShearPlane plane;
  PlaneImage image;
  Eigen::VectorXf
      harmonics;  // [harmonic_count(degree)]: Y_lm times the solid angle that the direction stands for
  float known_share = 0;  // its own solid angle over 4π, where it was measured
};

// Running sums of L_lm += Y_lm Ω L over directions, and of the part of the sphere that is known, at every grid point:
// all that a field's memory needs, however many probes and directions there are.
// source: Löw et al. 2009, equation 3
class FieldSums {
 public:
  FieldSums(const FieldGrid& grid, int degree);  // 0 everywhere
  explicit FieldSums(LightField sums);           // goes on from these

  // Adds a batch of directions to the points of slab z. Slabs are independent of each other: threads may share them out,
  // and the sums are the same to the last bit as long as batches come in the same order.
  void add(std::span<const FieldDirection> batch, int z);
  [[nodiscard]] int slabs() const { return grid_.size[2]; }
  // Adds other sums to slab z, as field() stores them: [harmonic][R, G, B][y][x] and [y][x].
  void add(std::span<const float> radiance, std::span<const float> confidence, int z);
  [[nodiscard]] std::span<const float> radiance(int z) const;
  [[nodiscard]] std::span<const float> confidence(int z) const;
  // Back to 0.
  void clear();

  [[nodiscard]] const LightField& field() const { return field_; }
  // Moves the sums out.
  [[nodiscard]] LightField take() &&;
  // What a field of this size needs while it is built, bytes.
  [[nodiscard]] static double bytes_needed(const FieldGrid& grid, int degree);

 private:
  FieldGrid grid_;
  int degree_;
  LightField field_;
};

}  // namespace lightwell
