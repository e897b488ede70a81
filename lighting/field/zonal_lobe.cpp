// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/zonal_lobe.h"

#include <algorithm>
#include <cmath>

#include "lighting/result.h"

namespace lightwell {
namespace {

using Harmonics = std::array<double, harmonic_count(kMostFieldDegree)>;

Harmonics project(std::span<const GatheredDirection> gathered, int degree) {
  Harmonics sum{}, values{};
  for (const GatheredDirection& g : gathered) {
    harmonics(g.direction, degree, values.data());
    for (std::size_t i = 0; i < static_cast<std::size_t>(harmonic_count(degree)); ++i)
      sum[i] += g.weight * values[i];
  }
  return sum;
}

// z_l = 4π / (2l + 1) Σ_m K_lm Y_lm(axis)
ZonalLobe about(const Harmonics& k, const Vec3d& normal, const Vec3d& mirrored, double toward_normal,
                int degree) {
  ZonalLobe lobe;
  lobe.toward_normal = toward_normal;
  Harmonics y{};
  harmonics(lobe.axis(normal, mirrored), degree, y.data());
  for (int l = 0; l <= degree; ++l) {
    double sum = 0;
    for (int m = -l; m <= l; ++m) {
      const auto i = static_cast<std::size_t>(harmonic_index(l, m));
      sum += k[i] * y[i];
    }
    lobe.bands[static_cast<std::size_t>(l)] = 4 * kPi / (2 * l + 1) * sum;
  }
  return lobe;
}

double kept(const ZonalLobe& lobe, int degree) {
  double sum = 0;
  for (int l = 0; l <= degree; ++l) {
    const double z = lobe.bands[static_cast<std::size_t>(l)];
    sum += (2 * l + 1) / (4 * kPi) * z * z;
  }
  return sum;
}

double value(const ZonalLobe& lobe, int degree, double cosine) {
  double before = 0, legendre = 1, sum = 0;
  for (int l = 0; l <= degree; ++l) {
    sum += lobe.bands[static_cast<std::size_t>(l)] * (2 * l + 1) / (4 * kPi) * legendre;
    before = std::exchange(legendre, ((2 * l + 1) * cosine * legendre - l * before) / (l + 1));
  }
  return sum;
}

bool rings_less(const ZonalLobe& lobe, int degree, double most_negative) {
  const double floor = -most_negative * value(lobe, degree, 1);
  constexpr int kSteps = 90;
  for (int i = 1; i <= kSteps; ++i)
    if (value(lobe, degree, std::cos(kPi * i / kSteps)) < floor) return false;
  return true;
}

}  // namespace

ZonalLobe zonal_lobe_about(std::span<const GatheredDirection> gathered, const Vec3d& normal,
                           const Vec3d& mirrored, double toward_normal, int degree) {
  return about(project(gathered, degree), normal, mirrored, toward_normal, degree);
}

ZonalLobe best_zonal_lobe(std::span<const GatheredDirection> gathered, const Vec3d& normal,
                          const Vec3d& mirrored, int degree) {
  verify_bug(degree >= 1 && degree <= kMostFieldDegree, "degree of a lobe out of range");
  const Harmonics k = project(gathered, degree);
  const auto at = [&](double t) { return about(k, normal, mirrored, t, degree); };
  // From a scan of the way between the two to the top beside its best place, by halving.
  constexpr int kScan = 16;
  double best = 0, most = kept(at(0), degree);
  for (int i = 1; i <= kScan; ++i) {
    const double t = static_cast<double>(i) / kScan;
    if (const double here = kept(at(t), degree); here > most) {
      best = t;
      most = here;
    }
  }
  for (double step = 0.5 / kScan; step > 1e-5; step /= 2)
    for (const double t : {best - step, best + step})
      if (const double here = kept(at(t), degree); here > most && t >= 0 && t <= 1) {
        best = t;
        most = here;
      }
  return at(best);
}

void widen(ZonalLobe& lobe, int degree, double tau) {
  for (int l = 1; l <= degree; ++l) lobe.bands[static_cast<std::size_t>(l)] *= std::exp(-l * (l + 1) * tau);
}

double widest_needed(int degree, double most_negative) {
  ZonalLobe mirror;
  mirror.bands.fill(1);
  double low = 0, high = 1;  // e^−2 of the first band, e^−6 of the second
  for (int i = 0; i < 30; ++i) {
    const double middle = (low + high) / 2;
    ZonalLobe wider = mirror;
    widen(wider, degree, middle);
    (rings_less(wider, degree, most_negative) ? high : low) = middle;
  }
  return high;
}

}  // namespace lightwell
