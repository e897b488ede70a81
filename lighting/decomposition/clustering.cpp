// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/clustering.h"

#include <algorithm>
#include <cmath>

#include "lighting/result.h"

namespace lightwell {

double cluster_radius_rad(int clusters, double solid_angle_sr, double covering_factor) {
  const double sine = std::sqrt(std::min(1.0, solid_angle_sr / (kPi * clusters)));
  return std::min(kPi, covering_factor * std::asin(sine));
}

Clustering::Clustering(int clusters, double theta_max_rad)
    : most_(static_cast<std::size_t>(clusters)), edge_cosine_(static_cast<float>(std::cos(theta_max_rad))) {
  verify_bug(clusters > 0, "at least one cluster");
  const double solid_angle = 2 * kPi * (1 - std::cos(theta_max_rad));
  cosine_ = clusters == 1 ? -2.0f : static_cast<float>(std::cos(cluster_radius_rad(clusters, solid_angle)));
  seed_x_.resize(most_);
  seed_y_.resize(most_);
  seed_z_.resize(most_);
  sum_.resize(most_);
  out_.resize(most_);
}

// The first cluster within the radius, used_ for a new one, or the nearest where no new one may be had.
std::size_t Clustering::cluster_of(float x, float y, float z) const noexcept {
  float nearest_cosine = -3;
  std::size_t nearest = 0;
  for (std::size_t c = 0; c < used_; ++c) {
    const float cosine = x * seed_x_[c] + y * seed_y_[c] + z * seed_z_[c];
    if (cosine >= cosine_) return c;
    if (cosine > nearest_cosine) {
      nearest_cosine = cosine;
      nearest = c;
    }
  }
  return used_ < most_ ? used_ : nearest;
}

std::span<const DirectionalLight> Clustering::apply(const LightArrays& lights) noexcept {
  used_ = 0;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const std::size_t c = cluster_of(lights.x[i], lights.y[i], lights.z[i]);
    if (c == used_) {
      seed_x_[c] = lights.x[i];
      seed_y_[c] = lights.y[i];
      seed_z_[c] = lights.z[i];
      sum_[c] = {0, 0, 0, 0, 0, 0, static_cast<std::uint32_t>(i)};
      ++used_;
    }
    const auto weight = static_cast<double>(luminance(Rgb(lights.r[i], lights.g[i], lights.b[i])));
    Sum& s = sum_[c];
    s.x += weight * static_cast<double>(lights.x[i]);
    s.y += weight * static_cast<double>(lights.y[i]);
    s.z += weight * static_cast<double>(lights.z[i]);
    s.r += static_cast<double>(lights.r[i]);
    s.g += static_cast<double>(lights.g[i]);
    s.b += static_cast<double>(lights.b[i]);
  }
  for (std::size_t c = 0; c < used_; ++c) {
    const Sum& s = sum_[c];
    const Rgbd illuminance(s.r, s.g, s.b);
    const Vec3d mean(s.x, s.y, s.z);
    const double length = mean.norm();
    Vec3f direction(seed_x_[c], seed_y_[c], seed_z_[c]);
    // Shorter than a hundredth of the members' power: opposite members, no direction in common.
    if (length > 0.01 * luminance(illuminance) && length > 0) {
      const Vec3f unit = (mean / length).cast<float>();
      if (unit.y() >= edge_cosine_ - 1e-6f) direction = unit;
    }
    out_[c] = {direction, illuminance.cast<float>(), -1, s.seed};
  }
  return {out_.data(), used_};
}

}  // namespace lightwell
