// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "lighting/fit/lambertian_probe.h"
#include "lighting/fit/shadow_ground.h"
#include "lighting/harmonics.h"
#include "lighting/result.h"
#include "lighting/vector.h"

namespace lightwell {

// What lights are fitted to: rows that were observed in each channel, and what a light or an ambient term gives each.
class FitObservations {
 public:
  virtual ~FitObservations() = default;

  // [rows][3], divided by a norm so that their size is about 1 whatever the light's.
  [[nodiscard]] const Eigen::Matrix<double, Eigen::Dynamic, 3>& observed() const { return observed_; }
  // A multiple of 4.
  [[nodiscard]] Eigen::Index rows() const { return observed_.rows(); }

  // What a light of unit illuminance gives, [rows]; its derivatives by a step of the direction along t and u.
  virtual void light_column(const Vec3d& direction, double* values) const noexcept = 0;
  virtual void slope_columns(const Vec3d& direction, const Vec3d& t, const Vec3d& u, double* along_t,
                             double* along_u) const noexcept = 0;
  // What unit radiance from everywhere gives.
  virtual void ambient_column(double* values) const noexcept = 0;

 protected:
  explicit FitObservations(Eigen::Index rows) {
    verify_bug(rows % 4 == 0, "inner products take four rows at a time");
    observed_.setZero(rows, 3);
  }
  Eigen::Matrix<double, Eigen::Dynamic, 3> observed_;
};

// The irradiance of the probe's faces and, where asked for, of the ground that the probe throws its shadow on. Each is
// divided by its own norm, so that both count alike.
class FaceObservations final : public FitObservations {
 public:
  explicit FaceObservations(bool with_shadow);

  // A probe that is black everywhere leaves scale 0 and all rows 0.
  void set_probe(const ProbeIrradiance& irradiance) noexcept;
  // After the probe. A ground without light has no say.
  void set_ground(const GroundIrradiance& irradiance) noexcept;
  // Fitted powers times this are lux.
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] bool with_shadow() const { return rows() > kProbeNormals; }
  // How many parts of norm 1 the rows have.
  [[nodiscard]] int parts() const { return ground_weight_ > 0 ? 2 : 1; }

  void light_column(const Vec3d& direction, double* values) const noexcept override;
  void slope_columns(const Vec3d& direction, const Vec3d& t, const Vec3d& u, double* along_t,
                     double* along_u) const noexcept override;
  void ambient_column(double* values) const noexcept override;

 private:
  std::vector<double> nx_, ny_, nz_;  // [320]
  ShadowGround ground_;
  double scale_ = 0;
  double ground_weight_ = 0;  // of a ground row against a probe row
};

// The same probe as spherical harmonics to degree 10: 72 rows in place of 320, and smooth, where a face that a light
// begins to reach makes a kink. A Lambertian probe has next to nothing beyond (1e-4 of a light's energy): here the
// search for the lights' places is quick, and the faces have the last word.
class BandObservations final : public FitObservations {
 public:
  static constexpr int kDegree = 10;
  BandObservations();

  // faces: with a probe set
  void set(const FaceObservations& faces) noexcept;

  void light_column(const Vec3d& direction, double* values) const noexcept override;
  void slope_columns(const Vec3d& direction, const Vec3d& t, const Vec3d& u, double* along_t,
                     double* along_u) const noexcept override;
  void ambient_column(double* values) const noexcept override;

 private:
  static constexpr std::array kBands = {0, 1, 2, 4, 6, 8, 10};  // irradiance has no others
  static constexpr int kHarmonics = 1 + 3 + 5 + 9 + 13 + 17 + 21;
  static constexpr int kRows = (kHarmonics + 3) / 4 * 4;  // the last ones stay 0
  using All = std::array<double, harmonic_count(kDegree)>;
  void keep(const All& all, double* rows) const noexcept;

  std::array<int, kHarmonics> index_;      // of the row among all harmonics
  std::array<double, kHarmonics> factor_;  // A_l
  Eigen::MatrixXd rows_from_faces_;        // [harmonics][faces], least squares of the faces' irradiance
};

}  // namespace lightwell
