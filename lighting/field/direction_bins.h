// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "lighting/field/probe_projection.h"
#include "lighting/field/sphere_partition.h"

namespace lightwell {

// Directions that all probes of a take see alike, for their optics and orientation are the same.
struct MeasuredDirection {
  Vec3d direction;               // mean of what is seen in a cell, unit
  Vec3d origin = Vec3d::Zero();  // mean origin of its rays, metres from a probe's position
  double solid_angle_sr = 0;     // that is seen
};

// Gathers pictures of one size into the cells of a partition: each cell has the mean radiance, by solid angle, of the
// part of the picture that falls into it, and every part falls into one, so that no light is lost or counted twice. A
// mirror ball's blind cone is neither black nor known: its directions stand for what the nearest seen cells show. What
// other projections do not see stays dark.
class DirectionBins {
 public:
  // width, height: of the pictures; cells: of the partition; degree: of harmonics().
  DirectionBins(const ProbeProjection& projection, int width, int height, int cells, int degree);
  // Memory while they are made, the most, of pictures that are no finer than the cells.
  [[nodiscard]] static double bytes_needed(int cells, int degree);

  // The cells that are seen, in the partition's order.
  [[nodiscard]] std::span<const MeasuredDirection> directions() const { return directions_; }
  // Part of the sphere that is seen, 0 to 1.
  [[nodiscard]] double coverage() const;
  // The mean radiance in each direction of what was seen of it; NaN where that is less than half. pixels:
  // [height][width], NaN where nothing was seen; out: [directions()].
  void mean_radiance(std::span<const Rgb> pixels, std::span<Rgb> out) const;
  // ∫ Y_lm over the part of the sphere that each direction stands for: column d, [harmonic_count(degree)].
  [[nodiscard]] const Eigen::MatrixXd& harmonics() const { return harmonics_; }

 private:
  struct Share {
    std::uint32_t pixel;
    float weight;  // a direction's sum to 1
  };
  void fill_blind_cone(const MirrorBallProbe& ball, double step_rad, int degree);
  std::size_t pixels_;
  std::vector<MeasuredDirection> directions_;
  std::vector<std::size_t> first_share_;  // [directions + 1]
  std::vector<Share> shares_;
  Eigen::MatrixXd harmonics_;
};

}  // namespace lightwell
