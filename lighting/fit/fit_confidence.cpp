// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/fit/fit_confidence.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

namespace lightwell {
namespace {

constexpr double kIndependent = 9;  // numbers in a probe's irradiance: harmonics l ≤ 2
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A derivative by a parameter: of channel c, factor × column; c = −1: of every channel, with the light's power.
struct Parameter {
  Eigen::Index column;
  int light;  // 0: ambient
  int channel;
};

}  // namespace

FitConfidence::FitConfidence(const FitObservations& observations)
    : observations_(observations),
      columns_(observations.rows(), kMostUnknowns + 2 * kMostFittedLights),
      products_(kMostUnknowns + 2 * kMostFittedLights, kMostUnknowns + 2 * kMostFittedLights) {}

FitSigmas FitConfidence::sigmas(const LightsTrial& trial) noexcept {
  std::array<Parameter, kMostParameters> parameters;
  std::size_t count = 0;
  const Eigen::Index slopes = trial.count + 1;
  observations_.ambient_column(columns_.col(0).data());
  for (int k = 0; k < trial.count; ++k) {
    const Vec3d d = trial.direction.col(k);
    const auto [t, u] = tangents_of(d);
    observations_.light_column(d, columns_.col(k + 1).data());
    observations_.slope_columns(d, t, u, columns_.col(slopes + 2 * k).data(),
                                columns_.col(slopes + 2 * k + 1).data());
    parameters[count++] = {slopes + 2 * k, k + 1, -1};
    parameters[count++] = {slopes + 2 * k + 1, k + 1, -1};
  }
  for (int v = 0; v <= trial.count; ++v)
    for (int c = 0; c < 3; ++c)
      if (trial.power(v, c) > 0) parameters[count++] = {v, v, c};

  const Eigen::Index columns = slopes + 2 * trial.count;
  for (Eigen::Index a = 0; a < columns; ++a)
    for (Eigen::Index b = 0; b <= a; ++b)
      products_(a, b) = products_(b, a) = columns_.col(a).dot(columns_.col(b));
  const auto size = static_cast<Eigen::Index>(count);
  normal_.resize(size, size);
  for (Eigen::Index a = 0; a < size; ++a)
    for (Eigen::Index b = 0; b < size; ++b) {
      const Parameter& p = parameters[static_cast<std::size_t>(a)];
      const Parameter& q = parameters[static_cast<std::size_t>(b)];
      double channels = 0;
      for (int c = 0; c < 3; ++c) {
        const double of_p = p.channel < 0 ? trial.power(p.light, c) : p.channel == c ? 1 : 0;
        const double of_q = q.channel < 0 ? trial.power(q.light, c) : q.channel == c ? 1 : 0;
        channels += of_p * of_q;
      }
      normal_(a, b) = products_(p.column, q.column) * channels;
    }

  FitSigmas sigmas;
  sigmas.power.setZero();
  // To a unit diagonal: what is left then is how far parameters stand in for one another.
  const Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostParameters, 1> size_of =
      normal_.diagonal().cwiseSqrt();
  const bool all_seen = size == 0 || size_of.minCoeff() > 0;
  bool held = all_seen;
  if (all_seen) {
    for (Eigen::Index a = 0; a < size; ++a)
      for (Eigen::Index b = 0; b < size; ++b) normal_(a, b) /= size_of[a] * size_of[b];
    const Eigen::LLT<decltype(normal_)> factor(normal_);
    held = factor.info() == Eigen::Success;
    if (held) inverse_ = factor.solve(decltype(normal_)::Identity(size, size));
  }
  std::array<double, kMostParameters> sigma{};
  for (Eigen::Index a = 0; a < size; ++a) {
    // 1e12: one over the square root of a rounding, beyond which the factor is noise
    const bool good = held && inverse_(a, a) > 0 && inverse_(a, a) < 1e12;
    sigma[static_cast<std::size_t>(a)] =
        good ? std::sqrt(trial.cost / kIndependent * inverse_(a, a)) / size_of[a] : kInfinity;
  }
  for (int k = 0; k < trial.count; ++k) {
    const auto t = static_cast<std::size_t>(2 * k);
    sigmas.direction_rad[static_cast<std::size_t>(k)] =
        std::sqrt((sigma[t] * sigma[t] + sigma[t + 1] * sigma[t + 1]) / 2);
  }
  for (std::size_t i = 0; i < count; ++i)
    if (parameters[i].channel >= 0 && parameters[i].light > 0)
      sigmas.power(parameters[i].light - 1, parameters[i].channel) = sigma[i];
  return sigmas;
}

}  // namespace lightwell
