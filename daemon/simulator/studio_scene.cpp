// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "daemon/simulator/paint.h"

// A studio: two windows, dim walls, a key lamp that swings across, a fill lamp that is dimmed up and down,
// and a small practical lamp. Still, the same studio is the scenario `static`.
namespace lightwell::simulator {
namespace {

constexpr int kWidth = 720, kHeight = 360;  // 0.5°
constexpr double kDeg = kPi / 180;
constexpr std::int64_t kRoom = 0, kFillGlow = 1;

const Rgbd kWarm(1.25, 0.97, 0.62);  // about 3200 K, luminance 1

struct Window {
  double azimuth_deg, half_width_deg, lowest_deg, highest_deg;
  Rgbd radiance;
};
const std::array<Window, 2> kWindows = {
    {{75, 17, 18, 47, Rgbd(2500, 3000, 3700)}, {215, 12, 24, 45, Rgbd(1300, 1500, 1800)}}};

double ramp(double from, double to, double x) {
  return std::clamp((x - from) / (to - from), 0.0, 1.0);
}

// How much of a 1° wide edge lies inside: the image is smooth enough to interpolate.
double inside(const Window& w, double elevation_deg, double azimuth_deg) {
  const double away = std::abs(std::remainder(azimuth_deg - w.azimuth_deg, 360.0));
  return ramp(w.half_width_deg + 0.5, w.half_width_deg - 0.5, away) *
         ramp(w.lowest_deg - 0.5, w.lowest_deg + 0.5, elevation_deg) *
         ramp(w.highest_deg + 0.5, w.highest_deg - 0.5, elevation_deg);
}

Vec3d toward(double elevation_deg, double azimuth_deg) {
  return direction_from_spherical({(90 - elevation_deg) * kDeg, azimuth_deg * kDeg});
}

Rgbd room(const Vec3d& d) {
  const Spherical s = spherical_from_direction(d);
  const double elevation = 90 - s.theta_rad / kDeg;
  const double azimuth = s.lambda_rad / kDeg;
  Rgbd radiance =
      Rgbd(34, 36, 40) * (0.6 + 0.4 * d.y()) + Rgbd(18, 21, 26) * (1 + std::cos(s.lambda_rad - 255 * kDeg));
  for (const Window& w : kWindows) {
    const double part = inside(w, elevation, azimuth);
    radiance = (1 - part) * radiance + part * w.radiance;
  }
  return radiance;
}

class StudioScene final : public Scene {
 public:
  explicit StudioScene(bool moving) : moving_(moving) {}

  SceneMoment at(double begin_s, double end_s) const override {
    const double t = moving_ ? (begin_s + end_s) / 2 : 0;
    const double key_azimuth = 300 + 55 * std::sin(2 * kPi * t / 24);
    const double dimmer = 0.525 + 0.475 * std::cos(2 * kPi * t / 15);  // full at 0, never below 5 %
    SceneMoment moment;
    moment.parts = {{kRoom, 1}, {kFillGlow, dimmer}};
    moment.lights = {{toward(52, key_azimuth), 3 * kDeg, 900 * kWarm},
                     {toward(35, 150), 4 * kDeg, dimmer * Rgbd(420, 420, 420)},
                     {toward(12, 20), 0.5 * kDeg, 120 * kWarm}};
    return moment;
  }

  Layer layer(std::int64_t id) const override {
    if (id == kRoom) return paint_upper_half(kWidth, kHeight, room);
    const Vec3d fill = toward(35, 150);
    return paint_upper_half(kWidth, kHeight, [&](const Vec3d& d) {
      const double c = std::max(0.0, d.dot(fill));
      return Rgbd(Rgbd::Constant(6 + 45 * c * c * c * c));
    });
  }

  std::vector<std::int64_t> lasting_layers() const override { return {kRoom, kFillGlow}; }
  // The practical lamp: 150 lx over the 2.4e-4 sr of its disc is 6.3e5 cd/m².
  double brightest_cd_m2() const override { return 7e5; }

 private:
  bool moving_;
};

}  // namespace

std::shared_ptr<const Scene> make_studio_scene(bool moving) {
  return std::make_shared<StudioScene>(moving);
}

}  // namespace lightwell::simulator
