// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/near_lamp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace lightwell {
namespace {

// 1 − cos of half a degree: a probe this close to the line from the lamp says it all.
constexpr double kSameRay = 4e-5;

// What of each band an even disc about a direction keeps of a point's harmonics: ∫ P_l over the disc, of its mean 1.
void disc_bands(double cosine, int degree, double* bands) {
  bands[0] = 1;
  if (cosine > 1 - 1e-9) {
    std::fill(bands, bands + degree + 1, 1.0);
    return;
  }
  double before = 1, here = cosine;  // P_{l−1}, P_l
  for (int l = 1; l <= degree; ++l) {
    const double after = ((2 * l + 1) * cosine * here - l * before) / (l + 1);
    bands[l] = (before - after) / ((2 * l + 1) * (1 - cosine));
    before = here;
    here = after;
  }
}

}  // namespace

Rgbd intensity_toward(std::span<const LampEmission> emissions, const Vec3d& direction) {
  Rgbd sum = Rgbd::Zero();
  double total = 0;
  for (const LampEmission& emission : emissions) {
    const double apart = 1 - direction.dot(emission.direction) + kSameRay;
    const double weight = emission.weight / (apart * apart);
    sum += weight * emission.intensity;
    total += weight;
  }
  return sum / total;
}

void add_near_lamp(const LampTrack& lamp, std::span<const Vec3d> probes, std::span<const double> weights,
                   LightField& field) {
  std::vector<LampEmission> emissions;
  for (std::size_t n = 0; n < probes.size(); ++n)
    if (lamp.links[n].known && weights[n] > 0)
      emissions.push_back({(probes[n] - lamp.position).normalized(), weights[n], lamp.links[n].intensity});
  if (emissions.empty() || !(lamp.weight > 0)) return;
  const FieldGrid& grid = field.grid;
  const double least = std::max({lamp.radius_m, grid.cell().minCoeff() / 2, 1e-6});
  const int count = field.harmonics();
  const auto row = static_cast<std::size_t>(grid.size[0]);
  std::vector<float> values(static_cast<std::size_t>(count) * row), lux(3 * row);
  std::array<double, harmonic_count(kMostFieldDegree)> y;
  std::array<double, kMostFieldDegree + 1> bands;
  for (int k = 0; k < grid.size[2]; ++k)
    for (int j = 0; j < grid.size[1]; ++j) {
      for (std::size_t i = 0; i < row; ++i) {
        const Vec3d toward = lamp.position - grid.position(static_cast<int>(i), j, k);
        const double distance = std::max(toward.norm(), 1e-9);
        const Vec3d direction = toward / distance;
        const double reach = std::max(distance, least);
        const Rgbd illuminance = intensity_toward(emissions, -direction) * (lamp.weight / (reach * reach));
        for (std::size_t c = 0; c < 3; ++c)
          lux[c * row + i] = static_cast<float>(illuminance[static_cast<Eigen::Index>(c)]);
        harmonics(direction, field.degree, y.data());
        const double sine = std::min(1.0, lamp.radius_m / reach);
        disc_bands(std::sqrt(1 - sine * sine), field.degree, bands.data());
        for (int l = 0, h = 0; l <= field.degree; ++l)
          for (int m = -l; m <= l; ++m, ++h)
            values[static_cast<std::size_t>(h) * row + i] =
                static_cast<float>(bands[static_cast<std::size_t>(l)] * y[static_cast<std::size_t>(h)]);
      }
      for (int h = 0; h < count; ++h)
        for (int c = 0; c < 3; ++c) {
          const float* value = values.data() + static_cast<std::size_t>(h) * row;
          const float* of = lux.data() + static_cast<std::size_t>(c) * row;
          float* out = field.plane(k, h, c) + static_cast<std::size_t>(j) * row;
          for (std::size_t i = 0; i < row; ++i) out[i] += of[i] * value[i];
        }
    }
}

}  // namespace lightwell
