// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/luminaire/located_luminaire.h"

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "lighting/result.h"

namespace lightwell {
namespace {

constexpr int kPositions = 5;  // across a disc: 21 of them shine
constexpr int kPixels = 32;    // a hemisphere's side: 4° a pixel
constexpr int kInside = 8;     // parts of a square's side, to tell how much of it the disc covers

// Aimed along −Z; X level, or along the world's X where the aim is vertical.
Eigen::Matrix3d frame_aimed_at(const Vec3d& aim) {
  Eigen::Matrix3d frame;
  const Vec3d level = Vec3d::UnitY().cross(-aim);
  const Vec3d across = Vec3d::UnitX() + aim.x() * -aim;
  frame.col(2) = -aim;
  frame.col(0) = level.norm() > 1e-6 ? level.normalized() : across.normalized();
  frame.col(1) = frame.col(2).cross(frame.col(0));
  return frame;
}

// What of a disc's light each square of its grid has; sums to 1. [v][u]
std::vector<double> disc_shares(int side) {
  std::vector<double> shares;
  double sum = 0;
  for (int v = 0; v < side; ++v)
    for (int u = 0; u < side; ++u) {
      int inside = 0;
      for (int j = 0; j < kInside; ++j)
        for (int i = 0; i < kInside; ++i) {
          const Vec2d place = Vec2d(u + (i + 0.5) / kInside, v + (j + 0.5) / kInside) * (2.0 / side);
          inside += (place - Vec2d::Ones()).squaredNorm() <= 1;
        }
      shares.push_back(inside);
      sum += inside;
    }
  for (double& share : shares) share /= sum;
  return shares;
}

}  // namespace

LocatedLuminaire located_luminaire(std::span<const LampEmission> emissions, double radius_m) {
  verify_bug(!emissions.empty() && radius_m >= 0, "no probe sees the lamp");
  Vec3d aim = Vec3d::Zero();
  for (const LampEmission& emission : emissions)
    aim += emission.weight * luminance(emission.intensity) * emission.direction;
  if (!(aim.norm() > 1e-9)) aim = emissions.front().direction;
  LocatedLuminaire located;
  located.world_from_lamp = frame_aimed_at(aim.normalized());
  for (const LampEmission& emission : emissions)
    located.behind += !(located.world_from_lamp.col(2).dot(emission.direction) < 0);
  NearField near;
  LampPlanes& planes = near.intensity.planes;
  const int side = radius_m > 0 ? kPositions : 1;
  planes.positions = {side, side};
  planes.spacing_m = radius_m > 0 ? 2 * radius_m / side : 0.01;
  planes.first_m = Vec2d::Constant(-planes.spacing_m * (side - 1) / 2);
  planes.map = LampMap::hemisphere;
  planes.pixels = {kPixels, kPixels};
  planes.low_m = Vec2d::Constant(-1);
  planes.high_m = Vec2d::Constant(1);
  std::vector<Rgb> image;
  for (int t = 0; t < kPixels; ++t)
    for (int s = 0; s < kPixels; ++s) {
      const Vec3d direction = located.world_from_lamp * direction_from_square(planes.pixel_centre(s, t));
      image.push_back(intensity_toward(emissions, direction).cast<float>());
    }
  for (const double share : disc_shares(side))
    for (const Rgb& value : image) near.intensity.values.push_back(value * static_cast<float>(share));
  located.lamp.near = std::move(near);
  return located;
}

}  // namespace lightwell
