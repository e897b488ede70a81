// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lighting/field/light_field.h"
#include "lighting/field/surface_lobes.h"
#include "render/scene.h"

// What a surface returns of a light field, in double precision, one place at a time.
namespace lightwell::test {

// Σ_l w_l Σ_m L_lm Y_lm(d)
template <class Weights>
Rgbd gathered(const LightAtPoint& light, const Vec3d& direction, int degree, const Weights& weights) {
  std::vector<double> y(static_cast<std::size_t>(harmonic_count(degree)));
  harmonics(direction, degree, y.data());
  Rgbd sum = Rgbd::Zero();
  for (int l = 0; l <= degree; ++l)
    for (int m = -l; m <= l; ++m) {
      const int h = harmonic_index(l, m);
      sum += weights(l) * y[static_cast<std::size_t>(h)] * light.radiance.row(h).transpose();
    }
  return sum;
}

// Unclamped. The lobes are those of the exact material, not of a table.
inline Rgbd returned(const LightAtPoint& light, int degree, const render::Material& m, const Vec3d& normal,
                     const Vec3d& to_eye) {
  const auto band = [](const auto& bands) {
    return [&bands](int l) { return bands[static_cast<std::size_t>(l)]; };
  };
  const double cosine = normal.dot(to_eye);
  const Vec3d mirrored = 2 * cosine * normal - to_eye;
  const Rgbd base = m.base_color.cast<double>();
  if (m.model == render::Material::Model::phong) {
    Rgbd sum = base / kPi * gathered(light, normal, degree, irradiance_factor);
    if ((m.specular > 0).any()) {
      const SurfaceLobe s = phong_surface(static_cast<double>(m.exponent), cosine, degree);
      sum += m.specular.cast<double>() *
             gathered(light, s.lobe.axis(normal, mirrored), degree, band(s.lobe.bands));
    }
    return sum;
  }
  const double metallic = static_cast<double>(m.metallic);
  const Rgbd f0 = 0.04 * (1 - metallic) + metallic * base;
  const SurfaceLobe s = rough_surface(static_cast<double>(m.roughness), cosine, degree);
  const Vec3d axis = s.lobe.axis(normal, mirrored);
  const auto below = [&](int l) {
    return irradiance_factor(l) == 0 ? 0 : s.below[static_cast<std::size_t>(l)];
  };
  return (1 - metallic) * base * (1 - f0) * gathered(light, normal, degree, below) +
         f0 * gathered(light, axis, degree, band(s.lobe.bands)) + gathered(light, axis, degree, band(s.edge));
}

}  // namespace lightwell::test
