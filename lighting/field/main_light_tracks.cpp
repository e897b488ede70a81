// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/main_light_tracks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "lighting/field/main_light_search.h"

namespace lightwell {
namespace {

constexpr std::size_t kMostAsked = 300;  // points: a third of a millisecond a light
constexpr double kSettle_s = 0.1;        // time constant by which a direction follows
constexpr double kStep_rad = 0.02;
// A light that has less than this part of what makes a new one goes; one that two came to have within kSame is one.
constexpr double kKeep = 0.5;
constexpr double kSame_rad = 0.1;
// A new light takes the place of one that is weaker by this.
constexpr double kStronger = 2;
constexpr double kLeastWeight = 1e-3;  // of one that is there: its penalty stays far from the largest number

std::vector<Vec3d> pick(const std::vector<Vec3d>& from, const std::vector<std::size_t>& which) {
  std::vector<Vec3d> picked;
  for (const std::size_t i : which) picked.push_back(from[i]);
  return picked;
}

double angle(const Vec3d& a, const Vec3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

MainLightTracks::MainLightTracks(int count)
    : weights_(static_cast<std::size_t>(count), 0.0), wanted_(static_cast<std::size_t>(count), false) {
  lights_.directions.assign(static_cast<std::size_t>(count), Vec3d::UnitY());
  directions_ = lights_.directions;
}

std::vector<std::size_t> MainLightTracks::active() const {
  std::vector<std::size_t> list;
  for (std::size_t i = 0; i < weights_.size(); ++i)
    if (wanted_[i] || weights_[i] > 0) list.push_back(i);
  return list;
}

void MainLightTracks::begin(const LightField& field, const Vec3d& low, const Vec3d& high) {
  const MainLights found = find_main_lights(field, static_cast<int>(weights_.size()), low, high);
  for (std::size_t i = 0; i < found.directions.size(); ++i) {
    lights_.directions[i] = directions_[i] = found.directions[i];
    weights_[i] = 1;
    wanted_[i] = true;
  }
}

// Each that is wanted to where it explains most of what the others leave, and what is shown toward that.
void MainLightTracks::follow(const Eigen::MatrixXd& points, int degree, double dt_s) {
  const double part = 1 - std::exp(-dt_s / kSettle_s);
  const std::vector<std::size_t> all = active();
  for (const std::size_t i : all) {
    if (!wanted_[i]) continue;
    std::vector<std::size_t> others = all;
    std::erase(others, i);
    const MainLightBasis basis(pick(directions_, others), degree);
    directions_[i] = refined(basis.residual(points), directions_[i], degree, kStep_rad);
    Vec3d& shown = lights_.directions[i];
    if (angle(directions_[i], shown) > kHold_rad)
      shown = (shown + part * (directions_[i] - shown)).normalized();
  }
}

// Which lights go, and whether one comes.
void MainLightTracks::choose(const Eigen::MatrixXd& points, int degree) {
  const double total = total_of(points);
  if (!(total > 0)) return;  // darkness tells nothing
  const std::vector<std::size_t> all = active();
  const MainLightBasis basis(pick(directions_, all), degree);
  const Eigen::VectorXd shares = basis.powers(points).rowwise().sum() / total;
  const auto share = [&](std::size_t n) { return shares[1 + static_cast<Eigen::Index>(n)]; };
  for (std::size_t n = 0; n < all.size(); ++n) {
    if (share(n) < kKeep * kLeastMainLight) wanted_[all[n]] = false;
    for (std::size_t m = 0; m < n; ++m)
      if (wanted_[all[n]] && wanted_[all[m]] && angle(directions_[all[n]], directions_[all[m]]) < kSame_rad)
        wanted_[share(n) < share(m) ? all[n] : all[m]] = false;
  }
  const Eigen::MatrixXd residual = basis.residual(points);
  const Vec3d direction = brightest(residual, degree);
  const double strength = illuminance_from(residual, direction, degree) / total;
  if (strength < kLeastMainLight) return;
  for (std::size_t i = 0; i < weights_.size(); ++i)
    if (!wanted_[i] && weights_[i] == 0) {
      lights_.directions[i] = directions_[i] = direction;
      wanted_[i] = true;
      return;
    }
  // None is free: the weakest makes room, unless one does already.
  std::size_t weakest = 0;
  for (std::size_t n = 0; n < all.size(); ++n) {
    if (!wanted_[all[n]]) return;
    if (share(n) < share(weakest)) weakest = n;
  }
  if (!all.empty() && strength > kStronger * share(weakest)) wanted_[all[weakest]] = false;
}

const MainLights& MainLightTracks::update(const LightField& field, double dt_s, const Vec3d& low,
                                          const Vec3d& high) {
  if (!weights_.empty()) {
    const Eigen::MatrixXd points = points_in_box(field, low, high, kMostAsked);
    if (!began_ && total_of(points) > 0) {
      begin(field, low, high);
      began_ = true;
    } else if (began_) {
      follow(points, field.degree, dt_s);
      choose(points, field.degree);
      for (std::size_t i = 0; i < weights_.size(); ++i)
        weights_[i] = std::clamp(weights_[i] + (wanted_[i] ? dt_s : -dt_s) / kFade_s, 0.0, 1.0);
    }
  }
  std::vector<std::size_t> shown = active();
  std::erase_if(shown, [&](std::size_t i) { return weights_[i] < kLeastWeight; });
  std::vector<double> weights;
  for (const std::size_t i : shown) weights.push_back(weights_[i]);
  const MainLightBasis basis(pick(lights_.directions, shown), field.degree, weights);
  const std::vector<float> lux = illuminances(field, basis, shown.size());
  const std::size_t each = 3 * field.grid.points();
  lights_.illuminance.assign(weights_.size() * each, 0.0f);
  for (std::size_t n = 0; n < shown.size(); ++n)
    std::copy_n(&lux[n * each], each, &lights_.illuminance[shown[n] * each]);
  return lights_;
}

}  // namespace lightwell
