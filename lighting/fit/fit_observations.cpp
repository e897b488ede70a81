// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/fit/fit_observations.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace lightwell {
namespace {

// Without overflow or underflow of the squares: 1e-30 and 1e25 lux are as good as 1.
template <class Block>
double safe_norm(const Block& values) {
  const double largest = values.abs().maxCoeff();
  return largest > 0 ? largest * std::sqrt((values / largest).square().sum()) : 0;
}

}  // namespace

FaceObservations::FaceObservations(bool with_shadow)
    : FitObservations(kProbeNormals + (with_shadow ? kGroundPoints : 0)) {
  const ProbeNormals normals = probe_normals();
  for (Eigen::Index i = 0; i < kProbeNormals; ++i) {
    nx_.push_back(normals(0, i));
    ny_.push_back(normals(1, i));
    nz_.push_back(normals(2, i));
  }
}

void FaceObservations::set_probe(const ProbeIrradiance& irradiance) noexcept {
  scale_ = safe_norm(irradiance);
  ground_weight_ = 0;
  if (scale_ > 0)
    observed_.topRows<kProbeNormals>() = (irradiance / scale_).matrix();
  else
    observed_.setZero();
}

void FaceObservations::set_ground(const GroundIrradiance& irradiance) noexcept {
  const double norm = safe_norm(irradiance);
  ground_weight_ = norm > 0 && scale_ > 0 ? scale_ / norm : 0;
  if (ground_weight_ > 0)
    observed_.bottomRows<kGroundPoints>() = (irradiance / norm).matrix();
  else
    observed_.bottomRows<kGroundPoints>().setZero();
}

void FaceObservations::light_column(const Vec3d& direction, double* values) const noexcept {
  const double x = direction.x(), y = direction.y(), z = direction.z();
  for (std::size_t i = 0; i < kProbeNormals; ++i) {
    const double cosine = nx_[i] * x + ny_[i] * y + nz_[i] * z;
    values[i] = cosine > 0 ? cosine : 0;
  }
  if (!with_shadow()) return;
  ground_.light_column(direction, values + kProbeNormals);
  for (int i = 0; i < kGroundPoints; ++i) values[kProbeNormals + i] *= ground_weight_;
}

void FaceObservations::slope_columns(const Vec3d& d, const Vec3d& t, const Vec3d& u, double* along_t,
                                     double* along_u) const noexcept {
  for (std::size_t i = 0; i < kProbeNormals; ++i) {
    const double lit = nx_[i] * d.x() + ny_[i] * d.y() + nz_[i] * d.z() > 0 ? 1 : 0;
    along_t[i] = lit * (nx_[i] * t.x() + ny_[i] * t.y() + nz_[i] * t.z());
    along_u[i] = lit * (nx_[i] * u.x() + ny_[i] * u.y() + nz_[i] * u.z());
  }
  if (!with_shadow()) return;
  ground_.slope_columns(d, t, u, along_t + kProbeNormals, along_u + kProbeNormals);
  for (int i = 0; i < kGroundPoints; ++i) {
    along_t[kProbeNormals + i] *= ground_weight_;
    along_u[kProbeNormals + i] *= ground_weight_;
  }
}

void FaceObservations::ambient_column(double* values) const noexcept {
  std::fill_n(values, kProbeNormals, kPi);
  if (!with_shadow()) return;
  ground_.ambient_column(values + kProbeNormals);
  for (int i = 0; i < kGroundPoints; ++i) values[kProbeNormals + i] *= ground_weight_;
}

BandObservations::BandObservations() : FitObservations(kRows) {
  std::size_t row = 0;
  for (const int l : kBands)
    for (int m = -l; m <= l; ++m, ++row) {
      index_[row] = harmonic_index(l, m);
      factor_[row] = irradiance_factor(l);
    }
  const ProbeNormals normals = probe_normals();
  Eigen::MatrixXd at_faces(kProbeNormals, kHarmonics);
  All all;
  for (Eigen::Index i = 0; i < kProbeNormals; ++i) {
    harmonics(normals.col(i), kDegree, all.data());
    for (std::size_t k = 0; k < kHarmonics; ++k)
      at_faces(i, static_cast<Eigen::Index>(k)) = all[static_cast<std::size_t>(index_[k])];
  }
  rows_from_faces_ = (at_faces.transpose() * at_faces).ldlt().solve(at_faces.transpose());
}

void BandObservations::set(const FaceObservations& faces) noexcept {
  const auto& from = faces.observed();
  for (Eigen::Index c = 0; c < 3; ++c)
    for (Eigen::Index k = 0; k < kHarmonics; ++k)
      observed_(k, c) = rows_from_faces_.row(k).dot(from.col(c).head<kProbeNormals>());
}

void BandObservations::keep(const All& all, double* rows) const noexcept {
  for (std::size_t k = 0; k < kHarmonics; ++k)
    rows[k] = factor_[k] * all[static_cast<std::size_t>(index_[k])];
  std::fill(rows + kHarmonics, rows + kRows, 0.0);
}

void BandObservations::light_column(const Vec3d& direction, double* values) const noexcept {
  All all;
  harmonics(direction, kDegree, all.data());
  keep(all, values);
}

void BandObservations::slope_columns(const Vec3d& direction, const Vec3d& t, const Vec3d& u, double* along_t,
                                     double* along_u) const noexcept {
  All of_t, of_u;
  harmonic_slopes(direction, {t, u}, kDegree, {of_t.data(), of_u.data()});
  keep(of_t, along_t);
  keep(of_u, along_u);
}

// Radiance 1 is √(4π) Y_00.
void BandObservations::ambient_column(double* values) const noexcept {
  std::fill_n(values, kRows, 0.0);
  values[0] = kPi * std::sqrt(4 * kPi);
}

}  // namespace lightwell
