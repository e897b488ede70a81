// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/probe_projection.h"

#include <algorithm>
#include <cmath>

#include "lighting/direction.h"
#include "lighting/orientation.h"

namespace lightwell {
namespace {

struct Place {
  int width, height;
  double x, y;
};

std::optional<ProbeRay> ray(const LatLongProbe& probe, const Place& at) {
  if (at.y / at.height * kPi > probe.theta_max_rad) return std::nullopt;
  return ProbeRay{direction_from_lat_long(at.x / at.width, at.y / at.height)};
}

std::optional<ProbeRay> ray(const MirrorBallProbe& ball, const Place& at) {
  const double half = std::min(at.width, at.height) / 2.0;
  const double px = (at.x - at.width / 2.0) / half, py = (at.height / 2.0 - at.y) / half;
  const double rho = std::hypot(px, py);
  if (rho >= 1) return std::nullopt;
  // The rim is where the camera's rays graze the ball, so that the picture is scaled by their tangent there.
  Vec3d toward_ball = -Vec3d::UnitZ(), normal;
  if (ball.camera_distance_m) {
    const double distance = *ball.camera_distance_m / ball.radius_m;  // in radii
    const double grazing = 1 / std::sqrt(distance * distance - 1);
    toward_ball = Vec3d(px * grazing, py * grazing, -1).normalized();
    const double along = -toward_ball.z() * distance;
    const Vec3d camera(0, 0, distance);
    const double missed_by = distance * toward_ball.head<2>().norm();
    normal = camera + (along - std::sqrt(std::max(0.0, 1 - missed_by * missed_by))) * toward_ball;
  } else {
    normal = {px, py, std::sqrt(1 - rho * rho)};
  }
  const Vec3d direction = (toward_ball - 2 * toward_ball.dot(normal) * normal).normalized();
  if (-direction.z() > std::cos(blind_cone_rad(ball))) return std::nullopt;
  return ProbeRay{direction, ball.radius_m * normal};
}

std::optional<ProbeRay> ray(const FisheyeProbe& probe, const Place& at) {
  const Vec2d pixel(at.x - 0.5, at.y - 0.5);
  if (probe.lens.theta_rad(pixel) > probe.lens.max_theta_rad) return std::nullopt;
  return ProbeRay{world_from_camera_rotation(probe.lens.zenith) * probe.lens.unproject(pixel)};
}

}  // namespace

double blind_cone_rad(const MirrorBallProbe& ball) {
  return ball.camera_distance_m
             ? std::max(ball.blind_cone_rad, std::asin(ball.radius_m / *ball.camera_distance_m))
             : ball.blind_cone_rad;
}

std::optional<ProbeRay> ray_of(const ProbeProjection& projection, int width, int height, double x, double y) {
  return std::visit([&](const auto& probe) { return ray(probe, Place{width, height, x, y}); }, projection);
}

}  // namespace lightwell
