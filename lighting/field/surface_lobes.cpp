// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/surface_lobes.h"

#include <algorithm>
#include <cmath>

#include "lighting/field/gauss_legendre.h"

namespace lightwell {
namespace {

// At 0 all is seen from its side, and a lobe's weights vanish.
constexpr double kLeastCosine = 1e-3;
// Where mirrored eye and normal are one, what lies between them is not known.
constexpr double kMostCosine = 0.9999;
constexpr double kMostPlace = 0.9999;  // an exponent of 60,000

constexpr int kRings = 32;

// Of a quadrature over [0, 1].
struct Ring {
  double at = 0, weight = 0;
};
const std::array<Ring, kRings>& rings() {
  static const std::array<Ring, kRings> all = [] {
    const GaussLegendre rule = gauss_legendre(kRings);
    std::array<Ring, kRings> made;
    for (int i = 0; i < kRings; ++i)
      made[static_cast<std::size_t>(i)] = {(rule.nodes[i] + 1) / 2, rule.weights[i] / 2};
    return made;
  }();
  return all;
}

Vec3d across(const Vec3d& axis, double cosine, double azimuth) {
  const Vec3d u(axis.y(), -axis.x(), 0);  // the axis has no z
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  return axis * cosine + u * (sine * std::cos(azimuth)) + Vec3d::UnitZ() * (sine * std::sin(azimuth));
}

double within(double cosine) {
  return std::clamp(cosine, kLeastCosine, kMostCosine);
}

// What is still to be widened of a lobe that is already as wide as a Gaussian of this τ, so that it is as wide as the degree
// holds: to τ_degree from below, and nothing above; smooth between, for tables are interpolated.
double to_widen(double tau, int degree) {
  const double least = widest_needed(degree, kMostRinging);
  return std::pow(std::pow(tau, 6) + std::pow(least, 6), 1.0 / 6) - tau;
}

double schlick(double cosine) {
  return std::pow(1 - std::clamp(cosine, 0.0, 1.0), 5);
}

double step(int i) {
  return static_cast<double>(i) / (kLobeSteps - 1);
}

}  // namespace

// With t = u^(1 / (n + 1)) the lobe is even over u; with u = w² its tail has more of the rings.
std::vector<GatheredDirection> gathered_by_phong(double exponent, double cosine) {
  constexpr int kSectors = 24;
  const Vec3d mirrored = mirrored_eye(within(cosine));
  const double share = (exponent + 2) / (exponent + 1) / kSectors;
  std::vector<GatheredDirection> all;
  for (const auto& [w, weight] : rings())
    for (int s = 0; s < kSectors; ++s) {
      const double t = std::pow(w, 2 / (exponent + 1));
      const Vec3d d = across(mirrored, t, kPi * (s + 0.5) / kSectors);
      if (d.y() > 0) all.push_back({d, share * weight * 2 * w * d.y()});
    }
  return all;
}

// Half vectors are taken evenly by the distribution: with cos²θ = (1 − ξ) / (1 + (α² − 1) ξ), D n·h dh = dξ dφ / 2π, and
// dω = 4 v·h dh; ξ = 1 − w².
GatheredByRoughness gathered_by_roughness(double roughness, double cosine) {
  constexpr int kSectors = 32;
  const double nv = within(cosine);
  const double alpha2 = std::max(std::pow(roughness, 4), 1e-6);
  const Vec3d mirrored = mirrored_eye(nv);
  const Vec3d eye(-mirrored.x(), mirrored.y(), 0);
  GatheredByRoughness all;
  for (const auto& [w, share] : rings())
    for (int s = 0; s < kSectors; ++s) {
      const double part = 1 - w * w;
      const double nh = std::sqrt((1 - part) / (1 + (alpha2 - 1) * part));
      const Vec3d h = across(Vec3d::UnitY(), nh, kPi * (s + 0.5) / kSectors);
      const double vh = eye.dot(h);
      const Vec3d d = 2 * vh * h - eye;
      if (!(vh > 0) || !(d.y() > 0)) continue;
      const double visibility = 0.5 / (d.y() * std::sqrt(alpha2 + (1 - alpha2) * nv * nv) +
                                       nv * std::sqrt(alpha2 + (1 - alpha2) * d.y() * d.y()));
      const double weight = visibility * d.y() * 4 * vh / nh * share * 2 * w / kSectors;
      all.base.push_back({d, weight * (1 - schlick(vh))});
      all.edge.push_back({d, weight * schlick(vh)});
    }
  return all;
}

std::vector<GatheredDirection> gathered_below(double cosine) {
  constexpr int kSectors = 24;
  const Vec3d mirrored = mirrored_eye(cosine);
  const Vec3d eye(-mirrored.x(), mirrored.y(), 0);
  std::vector<GatheredDirection> all;
  for (const auto& [w, share] : rings())
    for (int s = 0; s < kSectors; ++s) {
      const Vec3d d = across(Vec3d::UnitY(), std::sqrt(w), kPi * (s + 0.5) / kSectors);
      const double vh = eye.dot((d + eye).normalized());
      all.push_back({d, (1 - schlick(vh)) * share / kSectors});
    }
  return all;
}

namespace {

std::array<double, kMostFieldDegree + 1> below(double cosine, int degree) {
  return zonal_lobe_about(gathered_below(cosine), Vec3d::UnitY(), mirrored_eye(cosine), 1, degree).bands;
}

SurfaceLobe rough_lobe(double roughness, double cosine, int degree) {
  const GatheredByRoughness gathered = gathered_by_roughness(roughness, cosine);
  const Vec3d normal = Vec3d::UnitY(), mirrored = mirrored_eye(within(cosine));
  SurfaceLobe surface;
  surface.lobe = best_zonal_lobe(gathered.base, normal, mirrored, degree);
  ZonalLobe edge = zonal_lobe_about(gathered.edge, normal, mirrored, surface.lobe.toward_normal, degree);
  // A half vector's slopes have a variance of α²/2 an axis, and reflection doubles the angle.
  const double tau = to_widen(std::pow(roughness, 4), degree);
  widen(surface.lobe, degree, tau);
  widen(edge, degree, tau);
  surface.edge = edge.bands;
  return surface;
}

}  // namespace

SurfaceLobe phong_surface(double exponent, double cosine, int degree) {
  SurfaceLobe surface;
  surface.lobe = best_zonal_lobe(gathered_by_phong(exponent, cosine), Vec3d::UnitY(),
                                 mirrored_eye(within(cosine)), degree);
  widen(surface.lobe, degree, to_widen(0.5 / (exponent + 2), degree));
  return surface;
}

SurfaceLobe rough_surface(double roughness, double cosine, int degree) {
  SurfaceLobe surface = rough_lobe(roughness, cosine, degree);
  surface.below = below(cosine, degree);
  return surface;
}

std::vector<SurfaceLobe> phong_table(int degree) {
  std::vector<SurfaceLobe> table;
  for (int row = 0; row < kLobeSteps; ++row)
    for (int column = 0; column < kLobeSteps; ++column) {
      const double place = std::min(step(column), kMostPlace);
      table.push_back(phong_surface(kExponentMiddle * place / (1 - place), step(row), degree));
    }
  return table;
}

std::vector<SurfaceLobe> roughness_table(int degree) {
  std::vector<SurfaceLobe> table;
  for (int row = 0; row < kLobeSteps; ++row) {
    const auto of_row = below(step(row), degree);
    for (int column = 0; column < kLobeSteps; ++column) {
      table.push_back(rough_lobe(step(column), step(row), degree));
      table.back().below = of_row;
    }
  }
  return table;
}

SurfaceLobe look_up(std::span<const SurfaceLobe> table, double place, double cosine) {
  const double x = std::clamp(place, 0.0, 1.0) * (kLobeSteps - 1);
  const double y = std::clamp(cosine, 0.0, 1.0) * (kLobeSteps - 1);
  const int column = std::min(static_cast<int>(x), kLobeSteps - 2);
  const int row = std::min(static_cast<int>(y), kLobeSteps - 2);
  SurfaceLobe sum;
  for (int k = 0; k < 4; ++k) {
    const int dx = k & 1, dy = k >> 1;
    const double share = (dx == 1 ? x - column : 1 - x + column) * (dy == 1 ? y - row : 1 - y + row);
    const SurfaceLobe& entry = table[static_cast<std::size_t>((row + dy) * kLobeSteps + column + dx)];
    sum.lobe.toward_normal += share * entry.lobe.toward_normal;
    for (std::size_t l = 0; l <= kMostFieldDegree; ++l) {
      sum.lobe.bands[l] += share * entry.lobe.bands[l];
      sum.edge[l] += share * entry.edge[l];
      sum.below[l] += share * entry.below[l];
    }
  }
  return sum;
}

}  // namespace lightwell
