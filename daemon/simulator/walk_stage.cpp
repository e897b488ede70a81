// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/simulator/walk_stage.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace lightwell::simulator {
namespace {

constexpr double kHalfX_m = 3, kHalfZ_m = 2.5, kCeiling_m = 1.6;
constexpr int kLensSamples = 61;

struct Lamp {
  Vec3d position_m;
  double radius_m;
  Rgbd intensity_cd;
};
const std::array<Lamp, 3> kLamps = {{{{-1.6, 0.9, 0.6}, 0.06, Rgbd(60, 46, 30)},
                                     {{2.1, 0.7, -1.4}, 0.08, Rgbd(44, 45, 46)},
                                     {{0.4, 1.4, 1.9}, 0.05, Rgbd(24, 25, 28)}}};

// What a projector throws on the ground at (x, z), as a part of its lens's radiance.
using Slide = Rgbd (*)(double x, double z);

// 2 × 2 squares of 0.3 m, 6 cm apart.
Rgbd four_squares(double x, double z) {
  const double u = x + 0.38, v = z + 0.28;  // from the middle
  const auto inside = [](double w) { return std::abs(w) > 0.03 && std::abs(w) < 0.33; };
  if (!inside(u) || !inside(v)) return Rgbd::Zero();
  if (v < 0) return u < 0 ? Rgbd(1, 0.06, 0.05) : Rgbd(0.08, 0.9, 0.12);
  return u < 0 ? Rgbd(0.05, 0.12, 1) : Rgbd(1, 0.85, 0.1);
}

Rgbd circle(double x, double z) {
  return std::hypot(x - 0.4, z - 0.4) < 0.25 ? Rgbd(1, 1, 1) : Rgbd(0, 0, 0);
}

// Blocked along x = 0.15.
Rgbd half_spot(double x, double z) {
  return x > 0.15 && std::hypot(x - 0.15, z + 0.1) < 0.75 ? Rgbd(1, 0.08, 0.04) : Rgbd(0, 0, 0);
}

struct ProjectorLens {
  Vec3d position_m;
  double radius_m;
  double radiance_cd_m2;
  Slide slide;
};
const std::array<ProjectorLens, 3> kProjectors = {{{{-1.2, 1.5, 0.2}, 0.07, 8e4, four_squares},
                                                   {{1.3, 1.5, 1.0}, 0.07, 6e4, circle},
                                                   {{0.5, 1.5, -1.5}, 0.07, 8e4, half_spot}}};

double cap_solid_angle_sr(double angular_radius_rad) {
  const double s = std::sin(angular_radius_rad / 2);
  return 4 * kPi * s * s;
}

// The mean over the lens, a disc that faces the place, of what the ray from it through the place carries: what it draws
// where the ray meets the ground.
Rgbd mean_over_lens(const ProjectorLens& lens, const Vec3d& at) {
  const Vec3d toward = (lens.position_m - at).normalized();
  const Vec3d side = toward.cross(Vec3d::UnitX()).normalized(), up = side.cross(toward);
  Rgbd sum = Rgbd::Zero();
  for (int i = 0; i < kLensSamples; ++i) {
    const double radius = lens.radius_m * std::sqrt((i + 0.5) / kLensSamples);
    const double turn = 2.399963229728653 * i;  // the golden angle
    const Vec3d from = lens.position_m + radius * (std::cos(turn) * side + std::sin(turn) * up);
    const Vec3d ground = from + (at - from) * (from.y() / (from.y() - at.y()));
    sum += lens.slide(ground.x(), ground.z());
  }
  return sum / kLensSamples;
}

double ramp(double from, double to, double x) {
  return std::clamp((x - from) / (to - from), 0.0, 1.0);
}

// A window in the wall x = +3 m: z from −1 to 0.6 m, y from 0.2 to 1.2 m, with edges of 6 cm.
double window_part(const Vec3d& point, const Vec3d& normal) {
  if (normal.x() != -1) return 0;
  return ramp(-1.03, -0.97, point.z()) * ramp(0.63, 0.57, point.z()) * ramp(0.17, 0.23, point.y()) *
         ramp(1.23, 1.17, point.y());
}

// Where a ray from inside first meets a wall or the ceiling.
struct Hit {
  Vec3d point, normal;
};
Hit meet_wall(const Vec3d& from, const Vec3d& d) {
  const double tx = d.x() != 0 ? (std::copysign(kHalfX_m, d.x()) - from.x()) / d.x() : 1e9;
  const double tz = d.z() != 0 ? (std::copysign(kHalfZ_m, d.z()) - from.z()) / d.z() : 1e9;
  const double ty = d.y() > 0 ? (kCeiling_m - from.y()) / d.y() : 1e9;
  const double t = std::min({tx, ty, tz});
  Vec3d normal = Vec3d(0, -1, 0);
  if (t == tx)
    normal = {-std::copysign(1.0, d.x()), 0, 0};
  else if (t == tz)
    normal = {0, 0, -std::copysign(1.0, d.z())};
  return {from + t * d, normal};
}

}  // namespace

std::vector<DiscLight> stage_lights(const Vec3d& at) {
  std::vector<DiscLight> lights;
  const auto add = [&](const Vec3d& place, double radius_m, const Rgbd& radiance) {
    const Vec3d to = place - at;
    const double angle = std::asin(radius_m / to.norm());
    lights.push_back({to.normalized(), angle, radiance * cap_solid_angle_sr(angle)});
  };
  for (const Lamp& lamp : kLamps)
    add(lamp.position_m, lamp.radius_m, lamp.intensity_cd / (kPi * lamp.radius_m * lamp.radius_m));
  for (const ProjectorLens& lens : kProjectors)
    add(lens.position_m, lens.radius_m, lens.radiance_cd_m2 * mean_over_lens(lens, at));
  return lights;
}

Rgbd stage_wall_radiance(const Vec3d& at, const Vec3d& direction) {
  const Hit hit = meet_wall(at, direction);
  const Rgbd albedo = hit.normal.y() < 0 ? Rgbd(0.7, 0.7, 0.7) : Rgbd(0.55, 0.5, 0.45);
  Rgbd irradiance = Rgbd::Constant(12);
  for (const Lamp& lamp : kLamps) {
    const Vec3d to = lamp.position_m - hit.point;
    const double d2 = to.squaredNorm();
    irradiance += lamp.intensity_cd * (std::max(0.0, to.dot(hit.normal)) / (d2 * std::sqrt(d2)));
  }
  const double window = window_part(hit.point, hit.normal);
  return (1 - window) * albedo / kPi * irradiance + window * Rgbd(360, 420, 500);
}

}  // namespace lightwell::simulator
