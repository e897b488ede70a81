// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "daemon/simulator/paint.h"

// The probe is carried through a room with near lamps: their direction, size and strength change with its
// place. Metres; the probe's height is y = 0, the ceiling is above it. Light is not interreflected: walls
// show what lamps and windows throw on them, plus an even ambience.
namespace lightwell::simulator {
namespace {

constexpr int kWidth = 360, kHeight = 180;  // 1°
constexpr double kKeyframe_s = 0.25;
constexpr double kHalfX_m = 3, kHalfZ_m = 2.5, kCeiling_m = 1.6;

struct Lamp {
  Vec3d position_m;
  double radius_m;
  Rgbd intensity_cd;
};
const std::array<Lamp, 3> kLamps = {{{{-1.6, 0.9, 0.6}, 0.06, Rgbd(150, 115, 75)},
                                     {{2.1, 0.7, -1.4}, 0.08, Rgbd(110, 112, 115)},
                                     {{0.4, 1.4, 1.9}, 0.05, Rgbd(60, 62, 70)}}};

Vec3d probe_position(double time_s) {
  return {1.5 * std::sin(2 * kPi * time_s / 40), 0, 1.1 * std::sin(4 * kPi * time_s / 40)};
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

Rgbd wall_radiance(const Hit& hit) {
  const Rgbd albedo = hit.normal.y() < 0 ? Rgbd(0.7, 0.7, 0.7) : Rgbd(0.55, 0.5, 0.45);
  Rgbd irradiance = Rgbd::Constant(30);
  for (const Lamp& lamp : kLamps) {
    const Vec3d to = lamp.position_m - hit.point;
    const double d2 = to.squaredNorm();
    irradiance += lamp.intensity_cd * (std::max(0.0, to.dot(hit.normal)) / (d2 * std::sqrt(d2)));
  }
  const double window = window_part(hit.point, hit.normal);
  return (1 - window) * albedo / kPi * irradiance + window * Rgbd(900, 1050, 1250);
}

class WalkScene final : public Scene {
 public:
  SceneMoment at(double begin_s, double end_s) const override {
    const double middle = (begin_s + end_s) / 2;
    const double key = std::floor(middle / kKeyframe_s);
    const double w = middle / kKeyframe_s - key;
    const auto id = static_cast<std::int64_t>(key);
    SceneMoment moment;
    moment.parts = {{id, 1 - w}, {id + 1, w}};
    moment.position_m = probe_position(middle);
    for (const Lamp& lamp : kLamps) {
      const Vec3d to = lamp.position_m - *moment.position_m;
      const double alpha = std::asin(lamp.radius_m / to.norm());
      const double solid_angle = 4 * kPi * std::sin(alpha / 2) * std::sin(alpha / 2);
      const Rgbd radiance = lamp.intensity_cd / (kPi * lamp.radius_m * lamp.radius_m);
      moment.lights.push_back({to.normalized(), alpha, radiance * solid_angle});
    }
    return moment;
  }

  Layer layer(std::int64_t id) const override {
    const Vec3d from = probe_position(static_cast<double>(id) * kKeyframe_s);
    return paint_upper_half(kWidth, kHeight,
                            [&](const Vec3d& d) { return wall_radiance(meet_wall(from, d)); });
  }

  std::vector<std::int64_t> lasting_layers() const override { return {}; }
  double brightest_cd_m2() const override { return 2e4; }  // the first lamp's surface, 150 cd / (π 0.06² m²)
};

}  // namespace

std::shared_ptr<const Scene> make_walk_scene() {
  return std::make_shared<WalkScene>();
}

}  // namespace lightwell::simulator
