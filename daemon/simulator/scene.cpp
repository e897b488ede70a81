// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/simulator/scene.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace lightwell::simulator {
namespace {

constexpr std::array<std::string_view, 6> kScenarios = {"day",  "studio", "flicker",
                                                        "walk", "static", "stage"};
constexpr std::string_view kStageAt = "stage@";

Result<std::shared_ptr<const Scene>> make_stage_at(const std::string& name) {
  // A hand's breadth inside walls and ceiling.
  const Vec3d low(-2.9, 0, -2.4), high(2.9, 1.4, 2.4);
  Vec3d at;
  int used = 0;
  const std::string place = name.substr(kStageAt.size());
  if (std::sscanf(place.c_str(), "%lf,%lf,%lf%n", &at[0], &at[1], &at[2], &used) != 3 ||
      used != static_cast<int>(place.size()) || !((at - low).minCoeff() >= 0 && (high - at).minCoeff() >= 0))
    return Error{
        ErrorKind::usage,
        "scenario = " + name + ": allowed stage@X,Y,Z, metres, X -2.9 to 2.9, Y 0 to 1.4, Z -2.4 to 2.4"};
  return make_stage_scene(at);
}

}  // namespace

std::vector<Vec3d> disc_samples(const DiscLight& light, int count) {
  const Vec3d n = light.direction.normalized();
  const Vec3d helper = std::abs(n.y()) < 0.9 ? Vec3d(0, 1, 0) : Vec3d(1, 0, 0);
  const Vec3d s = n.cross(helper).normalized();
  const Vec3d t = n.cross(s);
  const double cap =
      2 * std::sin(light.angular_radius_rad / 2) * std::sin(light.angular_radius_rad / 2);  // 1 − cos α
  constexpr double kGoldenAngle = 2.39996322972865332;
  std::vector<Vec3d> samples;
  samples.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double below =
        cap * (i + 0.5) / count;  // 1 − cos of the angle from the axis: equal steps, equal solid angles
    const double sine = std::sqrt(below * (2 - below));
    const double turn = kGoldenAngle * i;
    samples.push_back((1 - below) * n + sine * (std::cos(turn) * s + std::sin(turn) * t));
  }
  return samples;
}

double part_above_horizon(const DiscLight& light) {
  const double elevation = std::asin(std::clamp(light.direction.normalized().y(), -1.0, 1.0));
  if (elevation >= light.angular_radius_rad) return 1;
  if (elevation <= -light.angular_radius_rad) return 0;
  // The horizon cuts discs for moments only: plane geometry of a small circle, error below α² relative.
  const double d = elevation / light.angular_radius_rad;
  return 1 - (std::acos(d) - d * std::sqrt(1 - d * d)) / kPi;
}

Rgbd cap_illuminance(const LatLongImage& image, double theta_max_rad) {
  Rgbd total = Rgbd::Zero();
  for (int y = 0; y < image.height && kPi * y / image.height < theta_max_rad; ++y) {
    const double top = kPi * y / image.height;
    const double bottom = std::min(kPi * (y + 1) / image.height, theta_max_rad);
    const double omega =
        2 * std::sin((top + bottom) / 2) * std::sin((bottom - top) / 2) * 2 * kPi / image.width;
    Rgbd row = Rgbd::Zero();
    for (int x = 0; x < image.width; ++x) row += image.at(x, y).cast<double>();
    total += omega * row;
  }
  return total;
}

std::span<const std::string_view> scenario_names() {
  return kScenarios;
}

bool names_scenario(std::string_view name) {
  return name.starts_with(kStageAt) ||
         std::find(kScenarios.begin(), kScenarios.end(), name) != kScenarios.end();
}

Result<std::shared_ptr<const Scene>> make_scenario(const std::string& name) {
  if (name == "day") return make_day_scene();
  if (name == "studio") return make_studio_scene(true);
  if (name == "static") return make_studio_scene(false);
  if (name == "flicker") return make_flicker_scene();
  if (name == "walk") return make_walk_scene();
  if (name == "stage") return make_stage_scene(Vec3d::Zero());
  if (name.starts_with(kStageAt)) return make_stage_at(name);
  std::string allowed;
  for (const std::string_view s : kScenarios) allowed += (allowed.empty() ? "" : ", ") + std::string(s);
  return Error{ErrorKind::usage, "scenario = " + name + ": allowed " + allowed};
}

}  // namespace lightwell::simulator
