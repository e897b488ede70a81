// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "daemon/simulator/paint.h"
#include "daemon/simulator/value_noise.h"

// A clear sky with sun and drifting clouds. Sky: Preetham, Shirley and Smits 1999, "A practical analytic
// model for daylight", appendix; sun: the same paper's attenuation by molecules and aerosol. South is +Z,
// west −X.
namespace lightwell::simulator {
namespace {

constexpr double kTurbidity = 2.5;          // a clear day
constexpr double kDayLength_s = 90;         // morning to afternoon and back
constexpr double kKeyframe_s = 1;           // the sky between two keyframes is their mixture
constexpr int kWidth = 360, kHeight = 180;  // 1°: nothing in the sky but the sun is sharper
constexpr double kLatitude_rad = 45 * kPi / 180, kDeclination_rad = 15 * kPi / 180;
constexpr double kSunRadius_rad = 0.2666 * kPi / 180;
constexpr double kSunOutside_lux = 128000;  // above the atmosphere

// Back and forth along one day's path, within five hours of noon: the sun stays above 20°.
Vec3d sun_direction(double time_s) {
  const double hour = -75 * kPi / 180 * std::cos(2 * kPi * time_s / kDayLength_s);
  const double sl = std::sin(kLatitude_rad), cl = std::cos(kLatitude_rad);
  const double sd = std::sin(kDeclination_rad), cd = std::cos(kDeclination_rad);
  return {-cd * std::sin(hour), sl * sd + cl * cd * std::cos(hour), sl * cd * std::cos(hour) - cl * sd};
}

// Illuminance facing the sun under a clear sky. Wavelengths of the Rec. 709 primaries in micrometres.
Rgbd clear_sun_illuminance(double elevation_rad) {
  const double degrees = elevation_rad * 180 / kPi;
  const double air_mass = 1 / (std::sin(elevation_rad) + 0.15 * std::pow(degrees + 3.885, -1.253));
  const double beta = 0.04608 * kTurbidity - 0.04586;
  const auto transmitted = [&](double wavelength_um) {
    return std::exp(-air_mass *
                    (0.008735 * std::pow(wavelength_um, -4.08) + beta * std::pow(wavelength_um, -1.3)));
  };
  return kSunOutside_lux * Rgbd(transmitted(0.611), transmitted(0.549), transmitted(0.464));
}

struct Perez {
  double a, b, c, d, e;
  [[nodiscard]] double at(double cos_theta, double gamma, double cos_gamma) const {
    return (1 + a * std::exp(b / cos_theta)) * (1 + c * std::exp(d * gamma) + e * cos_gamma * cos_gamma);
  }
};

class Sky {
 public:
  explicit Sky(const Vec3d& sun) : sun_(sun), theta_s_(std::acos(std::clamp(sun.y(), -1.0, 1.0))) {
    const double t = kTurbidity;
    perez_ = {{{0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771,
                -0.0670 * t + 0.3703},
               {-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989,
                -0.0033 * t + 0.0452},
               {-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537,
                -0.0109 * t + 0.0529}}};
    const double chi = (4.0 / 9 - t / 120) * (kPi - 2 * theta_s_);
    const double s = theta_s_, s2 = s * s, s3 = s2 * s;
    zenith_ = {1000 * ((4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192),
               t * t * (0.00166 * s3 - 0.00375 * s2 + 0.00209 * s) +
                   t * (-0.02903 * s3 + 0.06377 * s2 - 0.03202 * s + 0.00394) +
                   (0.11693 * s3 - 0.21196 * s2 + 0.06052 * s + 0.25886),
               t * t * (0.00275 * s3 - 0.00610 * s2 + 0.00317 * s) +
                   t * (-0.04214 * s3 + 0.08970 * s2 - 0.04153 * s + 0.00516) +
                   (0.15346 * s3 - 0.26756 * s2 + 0.06670 * s + 0.26688)};
    for (std::size_t i = 0; i < 3; ++i) norm_[i] = zenith_[i] / perez_[i].at(1, theta_s_, std::cos(theta_s_));
  }

  // cd/m², linear Rec. 709
  [[nodiscard]] Rgbd radiance(const Vec3d& direction) const {
    const double cos_theta = std::max(direction.y(), 0.01);  // the model's exp(b / cos θ) ends at the horizon
    const double cos_gamma = std::clamp(direction.dot(sun_), -1.0, 1.0);
    const double gamma = std::acos(cos_gamma);
    std::array<double, 3> v{};
    for (std::size_t i = 0; i < 3; ++i) v[i] = norm_[i] * perez_[i].at(cos_theta, gamma, cos_gamma);
    const double big_y = v[0], x = v[1], y = v[2];
    const double big_x = big_y * x / y, big_z = big_y * (1 - x - y) / y;
    const Rgbd rgb(3.2404542 * big_x - 1.5371385 * big_y - 0.4985314 * big_z,  // XYZ to Rec. 709, D65
                   -0.9692660 * big_x + 1.8760108 * big_y + 0.0415560 * big_z,
                   0.0556434 * big_x - 0.2040259 * big_y + 1.0572252 * big_z);
    return rgb.max(0.0);
  }

 private:
  Vec3d sun_;
  double theta_s_;
  std::array<Perez, 3> perez_{};
  std::array<double, 3> zenith_{}, norm_{};
};

double smoothstep(double a, double b, double x) {
  const double t = std::clamp((x - a) / (b - a), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// Opacity of the cloud in a direction, 0 to 0.9: a drifting plane, thinned out toward the horizon where it
// would be finer than the grid.
double cloud(const Vec3d& direction, double time_s) {
  const double height = std::max(direction.y(), 0.1);
  const double x = 1.3 * direction.x() / height + 0.05 * time_s;
  const double z = 1.3 * direction.z() / height + 0.02 * time_s;
  return 0.9 * smoothstep(0.52, 0.72, fractal_noise(x, z, 4)) * smoothstep(0.05, 0.3, direction.y());
}

class DayScene final : public Scene {
 public:
  SceneMoment at(double begin_s, double end_s) const override {
    const double middle = (begin_s + end_s) / 2;
    const double key = std::floor(middle / kKeyframe_s);
    const double w = middle / kKeyframe_s - key;
    const auto id = static_cast<std::int64_t>(key);
    const Vec3d sun = sun_direction(middle);
    const Rgbd direct = clear_sun_illuminance(std::asin(sun.y())) * std::exp(-3 * cloud(sun, middle));
    return {{{id, 1 - w}, {id + 1, w}}, {{sun, kSunRadius_rad, direct}}, std::nullopt};
  }

  Layer layer(std::int64_t id) const override {
    const double time_s = static_cast<double>(id) * kKeyframe_s;
    const Vec3d sun = sun_direction(time_s);
    const Sky sky(sun);
    // A thick cloud sends on about half of what falls on the ground, evenly.
    const Rgbd lit = 0.5 / kPi * (clear_sun_illuminance(std::asin(sun.y())) * sun.y() + 12000.0);
    return paint_upper_half(kWidth, kHeight, [&](const Vec3d& d) {
      const double a = cloud(d, time_s);
      return Rgbd((1 - a) * sky.radiance(d) + a * lit);
    });
  }

  std::vector<std::int64_t> lasting_layers() const override { return {}; }
  double brightest_cd_m2() const override { return 2e9; }  // the sun itself: 128 klx over 6.8e-5 sr
};

}  // namespace

std::shared_ptr<const Scene> make_day_scene() {
  return std::make_shared<DayScene>();
}

}  // namespace lightwell::simulator
