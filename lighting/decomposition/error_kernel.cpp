// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/error_kernel.h"

#include <algorithm>
#include <cmath>

namespace lightwell {
namespace {

constexpr double kFullHeight = 0.5;  // |y| from which a shadow stays near the object

}  // namespace

placement_kernel::Shares kernel_shares() {
  return {static_cast<float>(kPlainShare), static_cast<float>(kGroundShare),
          static_cast<float>(kSoftening_rad * kSoftening_rad)};
}

double ground_share(double y) {
  return std::min(1.0, std::abs(y) / kFullHeight);
}

double ground_share_slope(double y) {
  if (std::abs(y) >= kFullHeight) return 0;
  return (y < 0 ? -1 : 1) / kFullHeight;
}

MomentVector lambertian_moments(const Vec3d& d) {
  const double a0 = kPi * std::sqrt(1 / (4 * kPi));
  const double a1 = 2 * kPi / 3 * std::sqrt(3 / (4 * kPi));
  const double a2 = kPi / 4 * std::sqrt(15 / (4 * kPi));
  const double a4 = -kPi / 24 * 0.75 * std::sqrt(1 / kPi);
  const double s5 = std::sqrt(5.0), s35 = std::sqrt(35.0), r2 = std::sqrt(2.0);
  // Polar axis +Y, azimuth from +Z toward +X: (x, y, z) of the textbook are our (z, x, y).
  const double x = d.z(), y = d.x(), z = d.y();
  const double xx = x * x, yy = y * y, zz = z * z;
  MomentVector m;
  m << a0,                                                                                               //
      a1 * y, a1 * z, a1 * x,                                                                            //
      a2 * x * y, a2 * y * z, a2 / (2 * std::sqrt(3.0)) * (3 * zz - 1), a2 * x * z, a2 / 2 * (xx - yy),  //
      a4 * s35 * x * y * (xx - yy), a4 * s35 / r2 * y * z * (3 * xx - yy), a4 * s5 * x * y * (7 * zz - 1),
      a4 * s5 / r2 * y * z * (7 * zz - 3), a4 / 4 * (35 * zz * zz - 30 * zz + 3),
      a4 * s5 / r2 * x * z * (7 * zz - 3), a4 * s5 / 2 * (xx - yy) * (7 * zz - 1),
      a4 * s35 / r2 * x * z * (xx - 3 * yy), a4 * s35 / 4 * (xx * (xx - 3 * yy) - yy * (3 * xx - yy));
  return m;
}

double moment_weight() {
  static const double weight = kIrradianceWeight / lambertian_moments(Vec3d::UnitY()).squaredNorm();
  return weight;
}

double error_kernel(const Vec3d& a, const Vec3d& b) {
  // Σ_l A_l² (2l + 1)/(4π) P_l(cos): the addition theorem's sum over orders of the moments' products.
  constexpr double p0 = kPi / 4, p1 = kPi / 3, p2 = 5 * kPi / 64, p4 = kPi / 256;
  constexpr double scale = kIrradianceWeight / (p0 + p1 + p2 + p4);
  const double square = (a - b).squaredNorm();
  const double c = 1 - square / 2;
  const double cc = c * c;
  const double irradiance = p0 + p1 * c + p2 / 2 * (3 * cc - 1) + p4 / 8 * ((35 * cc - 30) * cc + 3);
  const double share = kPlainShare + kGroundShare * ground_share(a.y()) * ground_share(b.y());
  return share * (3 - std::sqrt(square + kSoftening_rad * kSoftening_rad)) + scale * irradiance;
}

Vec3d moment_gradient(const Vec3d& d, const MomentVector& of) {
  const double a1 = 2 * kPi / 3 * std::sqrt(3 / (4 * kPi));
  const double a2 = kPi / 4 * std::sqrt(15 / (4 * kPi));
  const double a4 = -kPi / 24 * 0.75 * std::sqrt(1 / kPi);
  const double s3 = std::sqrt(3.0), s5 = std::sqrt(5.0), s35 = std::sqrt(35.0), r2 = std::sqrt(2.0);
  const double x = d.z(), y = d.x(), z = d.y();
  const double xx = x * x, yy = y * y, zz = z * z;
  const double p = a4 * s35, q = a4 * s35 / r2, r = a4 * s5, t = a4 * s5 / r2, u = a4 / 4, v = a4 * s5 / 2,
               w = a4 * s35 / 4;
  const double dx = a1 * of[3] + a2 * (y * of[4] + z * of[7] + x * of[8]) + p * y * (3 * xx - yy) * of[9] +
                    q * 6 * x * y * z * of[10] + r * y * (7 * zz - 1) * of[11] +
                    t * z * (7 * zz - 3) * of[14] + v * 2 * x * (7 * zz - 1) * of[15] +
                    q * z * 3 * (xx - yy) * of[16] + w * 4 * x * (xx - 3 * yy) * of[17];
  const double dy = a1 * of[1] + a2 * (x * of[4] + z * of[5] - y * of[8]) + p * x * (xx - 3 * yy) * of[9] +
                    q * z * 3 * (xx - yy) * of[10] + r * x * (7 * zz - 1) * of[11] +
                    t * z * (7 * zz - 3) * of[12] - v * 2 * y * (7 * zz - 1) * of[15] -
                    q * 6 * x * y * z * of[16] + w * 4 * y * (yy - 3 * xx) * of[17];
  const double dz =
      a1 * of[2] + a2 * (y * of[5] + s3 * z * of[6] + x * of[7]) + q * y * (3 * xx - yy) * of[10] +
      r * 14 * x * y * z * of[11] + t * y * (21 * zz - 3) * of[12] + u * (140 * zz * z - 60 * z) * of[13] +
      t * x * (21 * zz - 3) * of[14] + v * 14 * z * (xx - yy) * of[15] + q * x * (xx - 3 * yy) * of[16];
  return moment_weight() * Vec3d(dy, dz, dx);
}

}  // namespace lightwell
