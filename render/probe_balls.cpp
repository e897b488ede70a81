// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/probe_balls.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace lightwell::render {
namespace {

// radiance(normal in the world) for every pixel whose centre is on the ball.
template <class Radiance>
RadiancePicture draw_ball(const Mat4f& world_from_camera, int diameter, Radiance radiance) {
  RadiancePicture picture{diameter, diameter,
                          std::vector<float>(static_cast<std::size_t>(diameter * diameter) * 4, 0.0f)};
  const Eigen::Matrix3f world = world_from_camera.topLeftCorner<3, 3>();
  const auto size = static_cast<float>(diameter);
  for (int y = 0; y < diameter; ++y)
    for (int x = 0; x < diameter; ++x) {
      const float right = 2 * (static_cast<float>(x) + 0.5f) / size - 1;
      const float up = 1 - 2 * (static_cast<float>(y) + 0.5f) / size;
      const float rest = 1 - right * right - up * up;
      if (rest < 0) continue;
      const Rgb value = radiance(Vec3f(world * Vec3f(right, up, std::sqrt(rest))));
      float* pixel = &picture.rgba[4 * static_cast<std::size_t>(y * diameter + x)];
      pixel[0] = value[0];
      pixel[1] = value[1];
      pixel[2] = value[2];
      pixel[3] = 1;
    }
  return picture;
}

Rgb look_up(const LatLongImage& image, const Vec3f& direction, double turn_rad) {
  const double azimuth = std::atan2(direction.x(), direction.z()) - turn_rad;
  const double theta = std::acos(std::clamp(static_cast<double>(direction.y()), -1.0, 1.0));
  const double turns = 0.5 - azimuth / (2 * kPi);
  const double x = (turns - std::floor(turns)) * image.width - 0.5;
  const double y = theta / kPi * image.height - 0.5;
  const int column = static_cast<int>(std::floor(x));
  const int row = static_cast<int>(std::floor(y));
  const auto right = static_cast<float>(x - column);
  const auto down = static_cast<float>(y - row);
  const auto at = [&](int dx, int dy) -> const Rgb& {
    return image.at((column + dx + image.width) % image.width, std::clamp(row + dy, 0, image.height - 1));
  };
  return (1 - down) * ((1 - right) * at(0, 0) + right * at(1, 0)) +
         down * ((1 - right) * at(0, 1) + right * at(1, 1));
}

}  // namespace

RadiancePicture grey_ball(const LightSet& lights, const Mat4f& world_from_camera, int diameter) {
  return draw_ball(world_from_camera, diameter, [&](const Vec3f& normal) {
    Rgb illuminance = Rgb::Zero();
    for (const DirectionalLight& light : lights.lights)
      illuminance += light.illuminance * std::max(0.0f, normal.dot(light.direction));
    return Rgb(kGreyBallAlbedo * (illuminance / static_cast<float>(kPi) + lights.ambient));
  });
}

RadiancePicture mirror_ball(const LatLongImage& environment, double environment_turn_rad,
                            const Mat4f& world_from_camera, int diameter) {
  const Vec3f to_eye = world_from_camera.col(2).head<3>();
  return draw_ball(world_from_camera, diameter, [&](const Vec3f& normal) {
    const Vec3f mirrored = 2 * normal.dot(to_eye) * normal - to_eye;
    return look_up(environment, mirrored.normalized(), environment_turn_rad);
  });
}

}  // namespace lightwell::render
