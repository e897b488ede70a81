// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "daemon/simulator/mains_light.h"
#include "daemon/simulator/paint.h"

// Lamps that flicker faster than the camera: at twice 50 Hz and twice 60 Hz, and one dimmed by pulse width.
// What a frame shows is their mean over its exposure, integrated in closed form.
namespace lightwell::simulator {
namespace {

constexpr int kWidth = 360, kHeight = 180;
constexpr double kDeg = kPi / 180;
enum : std::int64_t { kAmbient, kGlow100, kGlow120, kGlowPulsed };

Vec3d lamp_direction(std::int64_t glow) {
  const double azimuth_deg = glow == kGlow100 ? 40 : glow == kGlow120 ? 160 : 280;
  return direction_from_spherical({45 * kDeg, azimuth_deg * kDeg});
}

class FlickerScene final : public Scene {
 public:
  SceneMoment at(double begin_s, double end_s) const override {
    const double m100 = mean_of_cosine(100, 0.9, begin_s, end_s);
    const double m120 = mean_of_cosine(120, 0.4, begin_s, end_s);
    const double pulsed = mean_of_pulses(250, 0.3, begin_s, end_s);
    SceneMoment moment;
    moment.parts = {{kAmbient, 1}, {kGlow100, m100}, {kGlow120, m120}, {kGlowPulsed, pulsed}};
    moment.lights = {{lamp_direction(kGlow100), 2 * kDeg, m100 * Rgbd(400, 380, 300)},
                     {lamp_direction(kGlow120), 2 * kDeg, m120 * Rgbd(300, 320, 300)},
                     {lamp_direction(kGlowPulsed), 1 * kDeg, pulsed * Rgbd(250, 260, 330)}};
    return moment;
  }

  Layer layer(std::int64_t id) const override {
    return paint_upper_half(kWidth, kHeight, [&](const Vec3d& d) {
      const double c = id == kAmbient ? 0 : std::max(0.0, d.dot(lamp_direction(id)));
      return Rgbd(Rgbd::Constant(id == kAmbient ? 15 + 10 * d.y() : 3 + 30 * c * c * c));
    });
  }

  std::vector<std::int64_t> lasting_layers() const override {
    return {kAmbient, kGlow100, kGlow120, kGlowPulsed};
  }
  double brightest_cd_m2() const override {
    return 1.2e6;
  }  // the pulsed lamp while on: 330 / 0.3 lx over 9.6e-4 sr
  double default_exposure_us() const override {
    return 4000;
  }  // shorter than a flicker's period, so that it shows
};

}  // namespace

double mean_of_cosine(double frequency_hz, double depth, double begin_s, double end_s) {
  const double w = 2 * kPi * frequency_hz;
  return 1 - depth * (std::sin(w * end_s) - std::sin(w * begin_s)) / (w * (end_s - begin_s));
}

double mean_of_pulses(double frequency_hz, double duty, double begin_s, double end_s) {
  const auto on_until = [&](double t) {
    const double periods = t * frequency_hz;
    const double whole = std::floor(periods);
    return (whole * duty + std::min(periods - whole, duty)) / frequency_hz;
  };
  return (on_until(end_s) - on_until(begin_s)) / (duty * (end_s - begin_s));
}

std::shared_ptr<const Scene> make_flicker_scene() {
  return std::make_shared<FlickerScene>();
}

}  // namespace lightwell::simulator
