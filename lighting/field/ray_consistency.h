// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lighting/field/nearest_samples.h"
#include "lighting/vector.h"

namespace lightwell {

// A probe whose rays are not what those of the others foretell.
struct DoubtfulProbe {
  std::size_t probe = 0;
  double share = 0;  // of its rays that contradict, 0 to 1
};

// Whether the rays of a take can be of one field. In empty space that stands still, rays of one direction that pass near
// each other carry nearly the same light: a probe behind something, at a place that is not its own, or from before a lamp
// was moved breaks that, and in many directions, where a beam's edge does so in few.
class RayConsistency {
 public:
  explicit RayConsistency(std::size_t probes) : rays_(probes), contradicting_(probes) {}

  // One direction. samples: of all probes whose radiance is not NaN, in their order; support: rays of a fit. Each ray is
  // foretold from those of other places; it contradicts where that fails by more than six times the median of all, by more
  // than a twentieth of the direction's RMS radiance, and by more than for any of the `support` rays around it: what a
  // wrong ray does to those that are foretold from it is less than what it does to itself.
  void add(NearestSamples& samples, std::span<const Rgb> radiance, int support);

  // Probes of whose rays more than a third contradict, the worst first; among directions that have any light.
  [[nodiscard]] std::vector<DoubtfulProbe> doubtful() const;
  // RMS difference of rays that pass within a quarter of a cell of each other, as a part of their RMS radiance: noise, or
  // light that was not the same at different times. 0 where fewer than a hundred such pairs have come.
  [[nodiscard]] double close_difference() const;

 private:
  std::vector<std::size_t> rays_, contradicting_;  // [probes]
  std::size_t close_pairs_ = 0;
  double square_difference_ = 0, square_radiance_ = 0;
};

}  // namespace lightwell
