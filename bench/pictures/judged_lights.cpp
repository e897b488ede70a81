// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/pictures/judged_lights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "bench/painting.h"
#include "lighting/direction.h"

namespace lightwell::pictures {
namespace {

constexpr double kDegree = kPi / 180;

// height: even; twice as wide
LatLongImage painted(int height, const std::function<Rgb(const Vec3d&)>& radiance) {
  LatLongImage image{2 * height, height, {}};
  image.pixels.assign(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(height), Rgb::Zero());
  for (int y = 0; y < height / 2; ++y)
    for (int x = 0; x < image.width; ++x)
      image.at(x, y) = radiance(direction_from_lat_long((x + 0.5) / image.width, (y + 0.5) / height));
  return image;
}

// Adds a disc of a radiance; pixels on its edge by the part that lies inside.
void add_disc(LatLongImage& image, const Vec3d& centre, double radius_deg, const Rgb& radiance) {
  constexpr int kParts = 16;  // a pixel's side
  const double cosine = std::cos(radius_deg * kDegree);
  for (int y = 0; y < image.height / 2; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Vec3d middle = direction_from_lat_long((x + 0.5) / image.width, (y + 0.5) / image.height);
      if (middle.dot(centre) < std::cos((radius_deg + 0.6) * kDegree)) continue;
      int inside = 0;
      for (int part = 0; part < kParts * kParts; ++part) {
        const double u = (x + (part % kParts + 0.5) / kParts) / image.width;
        const double v = (y + (part / kParts + 0.5) / kParts) / image.height;
        inside += direction_from_lat_long(u, v).dot(centre) >= cosine ? 1 : 0;
      }
      image.at(x, y) += radiance * (static_cast<float>(inside) / (kParts * kParts));
    }
}

// Whether a direction passes a rectangle of zenith and azimuth between the bars that divide it.
bool through_window(const Spherical& s, double azimuth_from_deg, double azimuth_to_deg) {
  constexpr double kTop = 38, kSill = 78, kBar = 1.2;  // degrees
  const double zenith = s.theta_rad / kDegree;
  const double azimuth = s.lambda_rad / kDegree;
  if (zenith < kTop || zenith > kSill || azimuth < azimuth_from_deg || azimuth > azimuth_to_deg) return false;
  const double middle = (azimuth_from_deg + azimuth_to_deg) / 2;
  return std::abs(azimuth - middle) > kBar && std::abs(zenith - (kTop + kSill) / 2) > kBar;
}

}  // namespace

LatLongImage sun_light() {
  LatLongImage image = painted(512, bench::sky_radiance);
  add_disc(image, bench::from_degrees(48, 130), 0.265, Rgb(4.5e8f, 4.2e8f, 3.65e8f));
  return image;
}

LatLongImage night_light() {
  LatLongImage image = painted(256, [](const Vec3d& d) {
    const double glow = std::pow(1 - d.y(), 6);
    return Rgb((Rgbd(0.02, 0.022, 0.03) + glow * Rgbd(0.9, 0.6, 0.3)).cast<float>());
  });
  struct Lamp {
    double zenith_deg, azimuth_deg, radius_deg;
    Rgb radiance;
  };
  const std::array<Lamp, 8> lamps = {{{38, 65, 1.0, {21000, 13000, 4500}},
                                      {55, 150, 0.7, {15000, 15500, 14000}},
                                      {62, 230, 0.8, {17000, 9500, 2500}},
                                      {50, 300, 0.6, {9000, 11000, 14000}},
                                      {71, 350, 1.2, {3500, 3600, 3300}},
                                      {76, 20, 0.5, {16000, 2500, 1500}},
                                      {79, 110, 1.5, {1500, 1200, 700}},
                                      {25, 200, 0.4, {8000, 7500, 6500}}}};
  for (const Lamp& lamp : lamps)
    add_disc(image, bench::from_degrees(lamp.zenith_deg, lamp.azimuth_deg), lamp.radius_deg, lamp.radiance);
  return image;
}

LatLongImage window_light() {
  return painted(256, [](const Vec3d& d) {
    const Spherical s = spherical_from_direction(d);
    if (through_window(s, 20, 62) || through_window(s, 285, 318))
      return Rgb(0.6f * bench::sky_radiance(d) + Rgb(500, 520, 560));
    const double side = 1 + 0.6 * std::cos(s.lambda_rad - 0.7) * std::sin(s.theta_rad);
    return Rgb((side * Rgbd(26, 23, 19)).cast<float>());
  });
}

LatLongImage overcast_light() {
  return painted(256, [](const Vec3d& d) {
    const double slant = 1 / std::max(0.2, d.y());
    const double cloud = bench::cloud_noise(1.2 * d.x() * slant, 1.2 * d.z() * slant, 11);
    return Rgb((2500 * (1 + 2 * d.y()) / 3 * (0.75 + 0.5 * cloud) * Rgbd(0.96, 1, 1.06)).cast<float>());
  });
}

}  // namespace lightwell::pictures
