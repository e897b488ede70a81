// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/surface_lobes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lighting/field/phong_lobe.h"

namespace lightwell {
namespace {

double sum_of(const std::vector<GatheredDirection>& gathered) {
  double sum = 0;
  for (const GatheredDirection& g : gathered) sum += g.weight;
  return sum;
}

// The lobe's harmonics, turned as the surface has them.
std::vector<double> coefficients(const SurfaceLobe& surface, double cosine, int degree) {
  std::vector<double> y(static_cast<std::size_t>(harmonic_count(degree)));
  harmonics(surface.lobe.axis(Vec3d::UnitY(), mirrored_eye(cosine)), degree, y.data());
  for (int l = 0; l <= degree; ++l)
    for (int m = -l; m <= l; ++m)
      y[static_cast<std::size_t>(harmonic_index(l, m))] *= surface.lobe.bands[static_cast<std::size_t>(l)];
  return y;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference += (a[i] - b[i]) * (a[i] - b[i]);
    size += b[i] * b[i];
  }
  return std::sqrt(difference / size);
}

// Seen from straight above, the lobe times the cosine is zonal: (n + 2)/2π t^(n + 1).
TEST(SurfaceLobes, PhongFromAboveIsItsClosedForm) {
  for (const double exponent : {1.0, 4.0, 20.0, 300.0}) {
    const auto gathered = gathered_by_phong(exponent, 1);
    const ZonalLobe lobe = best_zonal_lobe(gathered, Vec3d::UnitY(), mirrored_eye(0.9999), 8);
    double moments[9];
    phong_moments(exponent + 1, 8, moments);
    for (int l = 0; l <= 8; ++l)  // "from above" is 0.8 degrees beside
      EXPECT_NEAR(lobe.bands[static_cast<std::size_t>(l)], (exponent + 2) * moments[l], 4e-4) << l;
  }
}

// An exponent of 1 is even in normal and mirrored eye: nothing speaks for one of them.
TEST(SurfaceLobes, TheAxisOfAnEvenLobeIsTheBisector) {
  EXPECT_NEAR(phong_surface(1, 0.5, 4).lobe.toward_normal, 0.5, 2e-3);
}

TEST(SurfaceLobes, NoOtherAxisOrBandsAreNearer) {
  const auto gathered = gathered_by_phong(6, 0.4);
  const Vec3d normal = Vec3d::UnitY(), mirrored = mirrored_eye(0.4);
  // ‖K − Σ z_l Z_l‖² but for ‖K‖²: −2 Σ z_l (2l + 1)/4π ∫K P_l + Σ (2l + 1)/4π z_l².
  const auto cost = [&](const ZonalLobe& lobe) {
    const ZonalLobe about = zonal_lobe_about(gathered, normal, mirrored, lobe.toward_normal, 4);
    double sum = 0;
    for (int l = 0; l <= 4; ++l) {
      const double z = lobe.bands[static_cast<std::size_t>(l)];
      sum += (2 * l + 1) / (4 * kPi) * z * (z - 2 * about.bands[static_cast<std::size_t>(l)]);
    }
    return sum;
  };
  const ZonalLobe best = best_zonal_lobe(gathered, normal, mirrored, 4);
  for (int l = 0; l <= 4; ++l)
    for (const double step : {-0.01, 0.01}) {
      ZonalLobe other = best;
      other.bands[static_cast<std::size_t>(l)] += step;
      EXPECT_GT(cost(other), cost(best));
    }
  for (double t = 0; t <= 1; t += 0.05)
    EXPECT_GE(cost(zonal_lobe_about(gathered, normal, mirrored, t, 4)), cost(best) * (1 + 1e-9));
}

// In a white furnace of radiance 1 a Phong lobe returns its specular part at normal incidence, and a rough mirror what
// Trowbridge–Reitz with Smith's masking does not lose: all of it where it is smooth.
TEST(SurfaceLobes, WhatIsGatheredOfEvenLightIsKnown) {
  EXPECT_NEAR(sum_of(gathered_by_phong(7, 1)), 1, 1e-3);
  const auto smooth = gathered_by_roughness(0.05, 0.7);
  EXPECT_NEAR(sum_of(smooth.base) + sum_of(smooth.edge), 1, 2e-3);
  EXPECT_NEAR(sum_of(smooth.edge), std::pow(0.3, 5), 1e-4);
  const auto rough = gathered_by_roughness(1, 1);
  EXPECT_LT(sum_of(rough.base) + sum_of(rough.edge), 1);
}

// Against even steps of the hemisphere, of the distribution as glTF states it.
TEST(SurfaceLobes, RoughLobesAreThoseOfTheModel) {
  const double roughness = 0.6, nv = 0.5, alpha2 = std::pow(roughness, 4);
  const Vec3d mirrored = mirrored_eye(nv), eye(-mirrored.x(), mirrored.y(), 0);
  Vec3d moment = Vec3d::Zero();
  double sum = 0;
  constexpr int kRings = 300, kSectors = 300;
  for (int r = 0; r < kRings; ++r)
    for (int s = 0; s < kSectors; ++s) {
      const double nl = (r + 0.5) / kRings, azimuth = 2 * kPi * (s + 0.5) / kSectors;
      const double sine = std::sqrt(1 - nl * nl);
      const Vec3d d(sine * std::cos(azimuth), nl, sine * std::sin(azimuth));
      const Vec3d h = (d + eye).normalized();
      const double t = h.y() * h.y() * (alpha2 - 1) + 1;
      const double masking = 0.5 / (nl * std::sqrt(alpha2 + (1 - alpha2) * nv * nv) +
                                    nv * std::sqrt(alpha2 + (1 - alpha2) * nl * nl));
      const double weight = alpha2 / (kPi * t * t) * masking * nl * 2 * kPi / (kRings * kSectors);
      sum += weight;
      moment += weight * d;
    }
  const auto gathered = gathered_by_roughness(roughness, nv);
  Vec3d ours = Vec3d::Zero();
  for (const auto* part : {&gathered.base, &gathered.edge})
    for (const GatheredDirection& g : *part) ours += g.weight * Vec3d(g.direction.x(), g.direction.y(), 0);
  EXPECT_NEAR(sum_of(gathered.base) + sum_of(gathered.edge), sum, 2e-3);
  EXPECT_NEAR(ours.x(), moment.x(), 2e-3);
  EXPECT_NEAR(ours.y(), moment.y(), 2e-3);
}

// What rings beside the brightest lamp: a mirror's lobe, widened, by no more than is allowed; its power stays.
TEST(SurfaceLobes, AMirrorRingsNoMoreThanAllowed) {
  for (int degree = 1; degree <= kMostFieldDegree; ++degree) {
    ZonalLobe lobe;
    lobe.bands.fill(1);
    widen(lobe, degree, widest_needed(degree, kMostRinging));
    EXPECT_EQ(lobe.bands[0], 1);
    double least = 0, peak = 0;
    for (int i = 0; i <= 180; ++i) {
      const double t = std::cos(kPi * i / 180);
      double value = 0, before = 0, legendre = 1;
      for (int l = 0; l <= degree; ++l) {
        value += lobe.bands[static_cast<std::size_t>(l)] * (2 * l + 1) / (4 * kPi) * legendre;
        const double next = ((2 * l + 1) * t * legendre - l * before) / (l + 1);
        before = legendre;
        legendre = next;
      }
      if (i == 0) peak = value;
      least = std::min(least, value);
    }
    EXPECT_GE(least, -1.01 * kMostRinging * peak) << degree;
    if (degree == 1) continue;
    EXPECT_LT(least, -0.9 * kMostRinging * peak) << degree;  // and no wider than needed
  }
}

// The tables as the renderer reads them, halfway between entries: rms .05 % of the lobe for exponents of 1 to 200, seen no
// flatter than 4 degrees; .2 % for roughness.
TEST(SurfaceLobes, TablesAreNearWhatTheyStandFor) {
  constexpr int kDegree = 4;
  const auto phong = phong_table(kDegree), rough = roughness_table(kDegree);
  double phong_squares = 0, rough_squares = 0;
  int count = 0;
  for (int i = 6; i < kLobeSteps - 3; i += 5)
    for (int j = 3; j < kLobeSteps - 1; j += 4, ++count) {
      const double place = (i + 0.5) / (kLobeSteps - 1), cosine = (j + 0.5) / (kLobeSteps - 1);
      const double exponent = kExponentMiddle * place / (1 - place);
      const auto error = [&](const SurfaceLobe& read, const SurfaceLobe& exact) {
        return std::pow(distance(coefficients(read, cosine, kDegree), coefficients(exact, cosine, kDegree)),
                        2);
      };
      phong_squares += error(look_up(phong, place, cosine), phong_surface(exponent, cosine, kDegree));
      rough_squares += error(look_up(rough, place, cosine), rough_surface(place, cosine, kDegree));
    }
  std::printf("tables, rms of lobes: Phong %.2e, roughness %.2e\n", std::sqrt(phong_squares / count),
              std::sqrt(rough_squares / count));
  EXPECT_LT(std::sqrt(phong_squares / count), 1e-3);
  EXPECT_LT(std::sqrt(rough_squares / count), 3e-3);
}

}  // namespace
}  // namespace lightwell
