// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "lighting/luminaire/measured_lamp.h"

// Lamps whose light is known everywhere. L cos² / R² between their planes is a sum of products of one function of (u, s) and
// one of (v, t), so that filters' images and illuminance are integrals in one dimension.
namespace lightwell::test {

// Of one axis: a bright place with a lobe that turns across it.
struct LampAxis {
  double centre = 0, width = 0.2;  // of the place, as a Gaussian; in distances of the planes, as all below
  double slope = 0, focus = 0;     // of the lobe at the centre, and how it changes along the place
  double lobe = 0.5;               // its width, as a slope
  double ripple = 0, ripple_period = 1;  // of the brightness along the place, relative
};

struct LampTerm {
  Rgbd amplitude = Rgbd::Ones();  // lux / m² there, distance 0.1 m
  std::array<LampAxis, 2> axes;   // (u, s) and (v, t)
};

struct AnalyticLamp {
  double distance_m = 0.1;
  std::vector<LampTerm> terms;

  // Metres; a term's product of both is L cos² / R².
  [[nodiscard]] double profile(const LampAxis& a, double u_m, double s_m) const {
    const double at = u_m / distance_m - a.centre, slope = (s_m - u_m) / distance_m;
    const double off = (slope - a.slope - a.focus * at) / a.lobe;
    const double fall = 1 + slope * slope;
    return std::exp(-at * at / (2 * a.width * a.width) - off * off / 2) *
           (1 + a.ripple * std::cos(2 * kPi * at / a.ripple_period)) / (fall * fall);
  }

  // Facing any way, of surfaces that see all of the lamp. In closed form but for one midpoint rule an axis, which for
  // Gaussians is as good as exact: with way = point − (u, v, 0), E = d² / depth³ ∫∫ (L cos² / R²) (−way · normal).
  [[nodiscard]] Rgbd illuminance(const Vec3d& point, const Vec3d& normal) const {
    const double depth = -point.z();
    Rgbd sum = Rgbd::Zero();
    for (const LampTerm& term : terms) {
      std::array<std::array<double, 2>, 2> moments{};  // ∫ f, ∫ f way
      for (int i = 0; i < 2; ++i) {
        const LampAxis& axis = term.axes[static_cast<std::size_t>(i)];
        constexpr int kSteps = 1200;
        const double reach = 7 * axis.width * distance_m, step = 2 * reach / kSteps;
        for (int k = 0; k < kSteps; ++k) {
          const double u = axis.centre * distance_m - reach + (k + 0.5) * step;
          const double way = point[i] - u;
          const double f = step * profile(axis, u, u + way * distance_m / depth);
          moments[static_cast<std::size_t>(i)][0] += f;
          moments[static_cast<std::size_t>(i)][1] += f * way;
        }
      }
      const auto& [x, y] = moments;
      sum += term.amplitude *
             (normal.z() * depth * x[0] * y[0] - normal.x() * x[1] * y[0] - normal.y() * x[0] * y[1]);
    }
    return sum * distance_m * distance_m / (depth * depth * depth);
  }

  // cd/m² along the ray.
  [[nodiscard]] Rgbd radiance(const Vec2d& sampling, const Vec2d& measurement) const {
    const double square = distance_m * distance_m + (measurement - sampling).squaredNorm();
    Rgbd sum = Rgbd::Zero();
    for (const LampTerm& term : terms)
      sum += term.amplitude * profile(term.axes[0], sampling.x(), measurement.x()) *
             profile(term.axes[1], sampling.y(), measurement.y());
    return sum * (square * square / (distance_m * distance_m));
  }
};

// A filament that shines everywhere, and its reflector, whose light spreads the more the farther out it starts.
inline AnalyticLamp reflector_lamp() {
  const LampAxis filament{0, 0.11, 0, 0, 0.7};
  const LampAxis mirror{0, 0.2, 0, 0.6, 0.5};
  return {0.1, {{Rgbd(1e6, 8e5, 5e5), {mirror, mirror}}, {Rgbd(9e5, 6e5, 3e5), {filament, filament}}}};
}

// Five by five warm and cold LEDs behind small lenses.
inline AnalyticLamp led_array() {
  AnalyticLamp lamp;
  for (int j = -2; j <= 2; ++j)
    for (int i = -2; i <= 2; ++i)
      lamp.terms.push_back(
          {(i + j) % 2 == 0 ? Rgbd(1e6, 8e5, 6e5) : Rgbd(7e5, 8e5, 1e6),
           {LampAxis{0.2 * i, 0.1, 0.05 * i, 0, 0.35}, LampAxis{0.2 * j, 0.1, 0.05 * j, 0, 0.35}}});
  return lamp;
}

// A spotlight's lens: a narrow beam that converges, its grooves across.
inline AnalyticLamp fresnel_lamp() {
  const LampAxis lens{0, 0.24, 0, -0.3, 0.3, 0.2, 0.4};
  return {0.1, {{Rgbd(2e6, 1.9e6, 1.7e6), {lens, lens}}}};
}

// Relative RMS over places and normals across a plane so far away, in distances of the planes; f: (point, normal) → lux.
template <class F>
double error_at(const AnalyticLamp& lamp, double distance, const F& f) {
  double error = 0, norm = 0;
  for (const auto& [x, y] :
       {std::pair(0.0, 0.0), std::pair(0.13, 0.22), std::pair(0.31, 0.0), std::pair(0.5, -0.22)}) {
    const Vec3d point = Vec3d(x, y, -distance) * lamp.distance_m;
    const Rgbd exact = lamp.illuminance(point, Vec3d::UnitZ());
    error += (f(point, Vec3d::UnitZ()) - exact).square().sum();
    norm += exact.square().sum();
  }
  return std::sqrt(error / norm);
}

}  // namespace lightwell::test
