// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/evaluation/coherence.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lighting/evaluation/latency.h"

namespace lightwell {
namespace {

double norm(const std::vector<Rgbd>& values) {
  double sum = 0;
  for (const Rgbd& v : values) sum += v.square().sum();
  return std::sqrt(sum);
}

double distance(const std::vector<Rgbd>& a, const std::vector<Rgbd>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).square().sum();
  return std::sqrt(sum);
}

// ‖(a − a_before) − (b − b_before)‖
double distance_of_changes(const std::vector<Rgbd>& a, const std::vector<Rgbd>& a_before,
                           const std::vector<Rgbd>& b, const std::vector<Rgbd>& b_before) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sum += ((a[i] - a_before[i]) - (b[i] - b_before[i])).square().sum();
  return std::sqrt(sum);
}

}  // namespace

ReferenceFrame reference_frame(const EvaluationGeometry& geometry, const PolarMap& map) {
  ReferenceFrame frame;
  geometry.shadow(map, frame.shadow);
  geometry.irradiance(map, frame.irradiance);
  const PolarGrid& grid = map.grid;
  std::vector<Vec2d> azimuths;
  for (int sector = 0; sector < grid.sectors; ++sector) {
    const double lambda = 2 * kPi * (sector + 0.5) / grid.sectors;
    azimuths.emplace_back(std::sin(lambda), std::cos(lambda));
  }
  Vec3d moment = Vec3d::Zero();
  std::size_t bin = 0;
  for (int ring = 0; ring < grid.rings; ++ring) {
    double power = 0;
    Vec2d along = Vec2d::Zero();
    for (const Vec2d& azimuth : azimuths) {
      const double flux =
          luminance(Rgbd(map.rgb(bin).cast<double>())) * static_cast<double>(map.solid_angle_sr[bin]);
      power += flux;
      along += flux * azimuth;
      ++bin;
    }
    const double theta = grid.theta_max_rad * (ring + 0.5) / grid.rings;
    frame.power += power;
    moment += Vec3d(std::sin(theta) * along[0], std::cos(theta) * power, std::sin(theta) * along[1]);
  }
  if (frame.power > 0) frame.direction = moment / frame.power;
  return frame;
}

CoherenceMeter::CoherenceMeter(Occluder occluder, std::optional<std::size_t> prefix)
    : occluder_(occluder), prefix_(prefix) {}

void CoherenceMeter::Track::add(const std::vector<Rgbd>& map, std::vector<Rgbd> lights, bool follows) {
  const double scale = norm(map);
  const double error = distance(lights, map) / scale;
  sum.error += error;
  sum.largest_error = std::max(sum.largest_error, error);
  ++frames;
  if (follows) {
    const double change = distance(lights, last_lights) / scale;
    const double reference = distance(map, last_map) / scale;
    sum.change += change;
    sum.reference_change += reference;
    sum.change_error += distance_of_changes(lights, last_lights, map, last_map) / scale;
    sum.largest_excess = std::max(sum.largest_excess, change - reference);
    ++changes;
  }
  last_map = map;
  last_lights = std::move(lights);
}

Steadiness CoherenceMeter::Track::mean() const {
  Steadiness mean = sum;
  const auto share = [](double total, std::size_t count) {
    return count > 0 ? total / static_cast<double>(count) : 0;
  };
  mean.error = share(sum.error, frames);
  mean.reference_change = share(sum.reference_change, changes);
  mean.change = share(sum.change, changes);
  mean.change_error = share(sum.change_error, changes);
  mean.excess = std::max(0.0, mean.change - mean.reference_change);
  return mean;
}

void CoherenceMeter::add(const ReferenceFrame& reference, const LightSet& set) {
  if (!(norm(reference.shadow) > 0) || !(norm(reference.irradiance) > 0)) {
    follows_ = false;
    return;
  }
  const LightSet lights = prefix_ ? take_lights(set, *prefix_) : set;
  shadow_.add(reference.shadow, shadow_of_lights(lights, occluder_), follows_);
  irradiance_.add(reference.irradiance, irradiance_of_lights(lights), follows_);
  follows_ = true;

  double power = 4 * kPi * luminance(Rgbd(lights.ambient.cast<double>()));
  Vec3d moment = Vec3d::Zero();
  for (const DirectionalLight& light : lights.lights) {
    const double flux = luminance(Rgbd(light.illuminance.cast<double>()));
    power += flux;
    moment += flux * light.direction.cast<double>();
  }
  power_.emplace_back(power, 0, 0);
  map_power_.emplace_back(reference.power, 0, 0);
  direction_.push_back(power > 0 ? Vec3d(moment / power) : Vec3d::Zero());
  map_direction_.push_back(reference.direction);
}

Coherence CoherenceMeter::result() const {
  return {shadow_.frames, shadow_.mean(), irradiance_.mean(), lag_frames(power_, map_power_),
          lag_frames(direction_, map_direction_)};
}

}  // namespace lightwell
