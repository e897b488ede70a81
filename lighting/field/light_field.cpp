// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/light_field.h"

#include <algorithm>
#include <cmath>

#include "lighting/result.h"

namespace lightwell {

const float* LightField::plane(int z, int harmonic, int channel) const {
  const int index = (z * harmonics() + harmonic) * 3 + channel;
  return radiance.data() + static_cast<std::size_t>(index) * slab_points();
}

float* LightField::plane(int z, int harmonic, int channel) {
  return const_cast<float*>(static_cast<const LightField*>(this)->plane(z, harmonic, channel));
}

LightAtPoint light_at(const LightField& field, const Vec3d& world) {
  verify_bug(field.grid.contains(world), "a field is asked inside its bounds");
  const Vec3d at = field.grid.grid_from_world(world);
  std::array<int, 3> base;
  Vec3d part;
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    base[axis] = std::clamp(static_cast<int>(at[a]), 0, field.grid.size[axis] - 2);
    part[a] = std::clamp(at[a] - base[axis], 0.0, 1.0);
  }
  LightAtPoint light;
  light.radiance.setZero(field.harmonics(), 3);
  for (int corner = 0; corner < 8; ++corner) {
    const std::array<int, 3> step = {corner & 1, corner >> 1 & 1, corner >> 2};
    double weight = 1;
    for (int a = 0; a < 3; ++a) weight *= step[static_cast<std::size_t>(a)] != 0 ? part[a] : 1 - part[a];
    const int z = base[2] + step[2];
    const auto in_slab =
        static_cast<std::size_t>((base[1] + step[1]) * field.grid.size[0] + base[0] + step[0]);
    for (int h = 0; h < field.harmonics(); ++h)
      for (int c = 0; c < 3; ++c)
        light.radiance(h, c) += weight * static_cast<double>(field.plane(z, h, c)[in_slab]);
    light.confidence +=
        weight *
        static_cast<double>(field.confidence[static_cast<std::size_t>(z) * field.slab_points() + in_slab]);
  }
  return light;
}

Rgbd irradiance(const LightAtPoint& light, const Vec3d& normal) {
  std::array<double, harmonic_count(kMostFieldDegree)> values;
  int degree = 0;
  while (harmonic_count(degree) < light.radiance.rows()) ++degree;
  harmonics(normal, degree, values.data());
  Rgbd sum = Rgbd::Zero();
  for (int l = 0; l <= degree; ++l)
    for (int m = -l; m <= l; ++m) {
      const int i = harmonic_index(l, m);
      sum += irradiance_factor(l) * values[static_cast<std::size_t>(i)] * light.radiance.row(i).transpose();
    }
  return sum;
}

}  // namespace lightwell
