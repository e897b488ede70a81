// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/sampled_lights.h"

#include "lighting/sampling/azimuth_seam.h"
#include "lighting/sampling/halton.h"
#include "lighting/sampling/light_arrays.h"
#include "lighting/sampling/random_points.h"
#include "lighting/sampling/relaxation.h"
#include "lighting/sampling/ring_distribution.h"
#include "lighting/sampling/ring_sampling.h"

namespace lightwell {
namespace {

std::vector<Vec2d> square_points(int count, Points points, std::uint32_t seed) {
  const auto size = static_cast<std::size_t>(count);
  if (points == Points::random) return random_points(size, seed);
  std::vector<Vec2d> square = halton_points(size, seed);
  if (points == Points::relaxed) relax_on_torus(square);
  return square;
}

struct Prepared {
  explicit Prepared(const PolarMap& map) : distribution(map.grid), seam(map.grid) {
    distribution.build(map);
    seam.follow(distribution);
  }
  RingDistribution distribution;
  AzimuthSeam seam;
};

template <class Sampler>
std::vector<DirectionalLight> lights_of(const PolarMap& map, const Sampler& sampler,
                                        const std::vector<Vec2d>& square) {
  LightArrays arrays(square.size());
  sample_lights(sampler, map, warp_points<Sampler>(square), arrays);
  std::vector<DirectionalLight> lights;
  lights.reserve(square.size());
  for (std::size_t i = 0; i < square.size(); ++i)
    lights.push_back({{arrays.x[i], arrays.y[i], arrays.z[i]},
                      {arrays.r[i], arrays.g[i], arrays.b[i]},
                      -1,
                      static_cast<std::uint32_t>(i)});
  return lights;
}

}  // namespace

std::vector<DirectionalLight> standard_lights(const PolarMap& map, int count, Points points,
                                              std::uint32_t seed) {
  const Prepared prepared(map);
  return lights_of(map, StandardInversion(prepared.distribution, prepared.seam),
                   square_points(count, points, seed));
}

std::vector<DirectionalLight> havran_lights(const PolarMap& map, int count, Points points,
                                            Interpolation interpolation, std::uint32_t seed) {
  const Prepared prepared(map);
  const auto method = interpolation == Interpolation::power ? HavranTransform::Interpolation::by_power
                                                            : HavranTransform::Interpolation::printed;
  return lights_of(map, HavranTransform(prepared.distribution, prepared.seam, method),
                   square_points(count, points, seed));
}

}  // namespace lightwell
