// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/harmonics.h"

#include <cmath>

#include "lighting/result.h"

namespace lightwell {
namespace {

constexpr int kOrders = kMostDegree + 2;  // of Q: a slope needs one more
using Table = std::array<std::array<double, kOrders>, kMostDegree + 1>;

// N_lm, with √2 for m > 0.
Table make_norms() {
  Table norms{};
  for (int l = 0; l <= kMostDegree; ++l)
    for (int m = 0; m <= l; ++m) {
      double ratio = 1;  // (l − m)! / (l + m)!
      for (int k = l - m + 1; k <= l + m; ++k) ratio /= k;
      norms[static_cast<std::size_t>(l)][static_cast<std::size_t>(m)] =
          std::sqrt((2 * l + 1) / (4 * kPi) * ratio * (m > 0 ? 2 : 1));
    }
  return norms;
}
const Table kNorms = make_norms();

// Q_lm = (2l − 1)/(l − m) y Q_{l−1,m} − (l + m − 1)/(l − m) Q_{l−2,m}
struct Recurrence {
  Table first{}, second{};
  Recurrence() {
    for (int l = 2; l <= kMostDegree; ++l)
      for (int m = 0; m <= l - 2; ++m) {
        const auto i = static_cast<std::size_t>(l), j = static_cast<std::size_t>(m);
        first[i][j] = (2.0 * l - 1) / (l - m);
        second[i][j] = (l + m - 1.0) / (l - m);
      }
  }
};
const Recurrence kRecurrence;

// Q_lm(y), the m-th derivative of the Legendre polynomial P_l, to m = l + 1: P_l^m = sin^m θ Q_lm without
// Condon–Shortley sign.
void legendre_derivatives(double y, int degree, Table& q) {
  double diagonal = 1;  // (2m − 1)!!
  for (std::size_t m = 0; m <= static_cast<std::size_t>(degree); ++m) {
    q[m][m] = diagonal;
    q[m][m + 1] = 0;
    const double odd = 2 * static_cast<double>(m) + 1;
    if (m < static_cast<std::size_t>(degree)) q[m + 1][m] = odd * y * diagonal;
    for (std::size_t l = m + 2; l <= static_cast<std::size_t>(degree); ++l)
      q[l][m] = kRecurrence.first[l][m] * y * q[l - 1][m] - kRecurrence.second[l][m] * q[l - 2][m];
    diagonal *= odd;
  }
}

// (z + i x)^m = sin^m θ e^{imλ}, real and imaginary part.
struct Powers {
  std::array<double, kOrders> re{}, im{};
  Powers(double z, double x, int degree) {
    re[0] = 1;
    for (std::size_t m = 1; m <= static_cast<std::size_t>(degree); ++m) {
      re[m] = re[m - 1] * z - im[m - 1] * x;
      im[m] = re[m - 1] * x + im[m - 1] * z;
    }
  }
};

}  // namespace

void harmonics(const Vec3d& direction, int degree, double* values) noexcept {
  verify_bug(degree >= 0 && degree <= kMostDegree, "degree of spherical harmonics out of range");
  Table q;
  legendre_derivatives(direction.y(), degree, q);
  const Powers power(direction.z(), direction.x(), degree);
  for (int l = 0; l <= degree; ++l)
    for (int m = 0; m <= l; ++m) {
      const auto i = static_cast<std::size_t>(l);
      const auto j = static_cast<std::size_t>(m);
      const double zonal = kNorms[i][j] * q[i][j];
      values[harmonic_index(l, m)] = zonal * power.re[j];
      if (m > 0) values[harmonic_index(l, -m)] = zonal * power.im[j];
    }
}

// Q_lm(y) Re (z + ix)^m is a polynomial: dQ_lm/dy = Q_l,m+1, and d(z + ix)^m = m (z + ix)^{m−1} (dz + i dx).
void harmonic_slopes(const Vec3d& direction, const std::array<Vec3d, 2>& along, int degree,
                     const std::array<double*, 2>& slopes) noexcept {
  verify_bug(degree >= 0 && degree <= kMostDegree, "degree of spherical harmonics out of range");
  Table q;
  legendre_derivatives(direction.y(), degree, q);
  const Powers power(direction.z(), direction.x(), degree);
  for (std::size_t k = 0; k < 2; ++k) {
    const Vec3d& t = along[k];
    double* out = slopes[k];
    std::array<double, kOrders> around_re, around_im;
    for (std::size_t j = 1; j <= static_cast<std::size_t>(degree); ++j) {
      const auto m = static_cast<double>(j);
      around_re[j] = m * (power.re[j - 1] * t.z() - power.im[j - 1] * t.x());
      around_im[j] = m * (power.re[j - 1] * t.x() + power.im[j - 1] * t.z());
    }
    for (int l = 0; l <= degree; ++l) {
      const auto i = static_cast<std::size_t>(l);
      out[harmonic_index(l, 0)] = kNorms[i][0] * q[i][1] * t.y();
      for (int m = 1; m <= l; ++m) {
        const auto j = static_cast<std::size_t>(m);
        const double along_y = q[i][j + 1] * t.y();
        out[harmonic_index(l, m)] = kNorms[i][j] * (along_y * power.re[j] + q[i][j] * around_re[j]);
        out[harmonic_index(l, -m)] = kNorms[i][j] * (along_y * power.im[j] + q[i][j] * around_im[j]);
      }
    }
  }
}

double irradiance_factor(int l) noexcept {
  if (l == 0) return kPi;
  if (l == 1) return 2 * kPi / 3;
  if (l % 2 == 1) return 0;
  // 2π (−1)^{l/2−1} / ((l + 2)(l − 1)) · l! / (2^l ((l/2)!)²)
  double share = 1;
  for (int k = 1; k <= l / 2; ++k) share *= (2.0 * k - 1) / (2.0 * k);
  return (l % 4 == 2 ? 1 : -1) * 2 * kPi / ((l + 2.0) * (l - 1.0)) * share;
}

}  // namespace lightwell
