// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lighting/light_set.h"
#include "lighting/sampling/light_arrays.h"

namespace lightwell {

// Angular radius of a cluster, so that Q of them cover a solid angle Ω: π sin² ε = Ω / Q, enlarged by the
// covering factor of discs. ε = c_f · arcsin √(Ω / (π Q)), in [0, π]; with the hemisphere's Ω = 2π the
// paper's c_f · arcsin √(2 / Q). The root is held to 1 where Q is below the formula's domain. source: Havran
// et al. 2005, section 4.3
double cluster_radius_rad(int clusters, double solid_angle_sr, double covering_factor = 1.85);

// Merges lights of like direction, in their progressive order: a light joins the first cluster whose seed
// lies within the radius, else seeds one; once there are Q, it joins the one with the nearest seed. So at
// most Q lights come out, in the order of their seeds. One cluster takes everything (Q = 1).
//
// Illuminance is summed (in double); the direction is the luminance-weighted mean of the members, that of the
// seed where the mean vanishes or falls outside of the map; the id is the seed's index. Allocates nothing
// after construction. source: Havran et al. 2005, section 4.3, whose greedy pass this is but for the bound,
// which it leaves open
class Clustering {
 public:
  // theta_max_rad: edge of the map, to size the clusters and to keep directions inside
  Clustering(int clusters, double theta_max_rad);

  // The clusters stay valid until the next call.
  std::span<const DirectionalLight> apply(const LightArrays& lights) noexcept;

 private:
  struct Sum {
    double x, y, z, r, g, b;
    std::uint32_t seed;
  };
  [[nodiscard]] std::size_t cluster_of(float x, float y, float z) const noexcept;

  std::size_t most_;
  float cosine_;       // of the radius
  float edge_cosine_;  // of the map's edge
  std::size_t used_ = 0;
  std::vector<float> seed_x_, seed_y_, seed_z_;
  std::vector<Sum> sum_;
  std::vector<DirectionalLight> out_;
};

}  // namespace lightwell
