// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/world_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lighting/direction.h"
#include "lighting/result.h"

namespace lightwell {
namespace {

constexpr int kSide = 2;  // pieces of a bin along a side
constexpr int kPieces = kSide * kSide;

Rgb unseen() {
  return Rgb::Constant(std::numeric_limits<float>::quiet_NaN());
}

}  // namespace

WorldPicture::WorldPicture(const PolarGrid& grid, std::vector<bool> seen)
    : grid_(grid),
      seen_(std::move(seen)),
      width_(grid.sectors),
      height_(static_cast<int>(std::lround(grid.rings * kPi / grid.theta_max_rad))) {
  verify_bug(seen_.size() == grid.size() && width_ % 2 == 0 &&
                 std::abs(height_ * grid.theta_max_rad / grid.rings - kPi) < 1e-9,
             "a map whose bins are no pixels");
  pieces_.reserve(grid.size() * kPieces);
  for (int ring = 0; ring < grid.rings; ++ring)
    for (int sector = 0; sector < grid.sectors; ++sector)
      for (int piece = 0; piece < kPieces; ++piece)
        pieces_.push_back(direction_from_spherical(
            {grid.theta_max_rad * (ring + (piece / kSide + 0.5) / kSide) / grid.rings,
             2 * kPi * (sector + (piece % kSide + 0.5) / kSide) / grid.sectors}));
}

void WorldPicture::paint_upright(const PolarMap& map, LatLongImage& out) const {
  verify_bug(map.grid == grid_, "a map of the picture's grid");
  out.width = width_;
  out.height = height_;
  out.pixels.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), unseen());
  for (int y = 0; y < grid_.rings; ++y)
    for (int x = 0; x < width_; ++x) {
      // Azimuth runs against the columns, from the middle of the picture (docs/conventions.md).
      const int sector = (3 * width_ / 2 - 1 - x) % width_;
      const std::size_t bin =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(sector);
      if (seen_[bin]) out.at(x, y) = map.rgb(bin);
    }
}

void WorldPicture::paint(const PolarMap& map, const Eigen::Quaterniond& world_from_probe, LatLongImage& out) {
  verify_bug(map.grid == grid_, "a map of the picture's grid");
  out.width = width_;
  out.height = height_;
  const auto pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  out.pixels.assign(pixels, Rgb::Zero());
  solid_angle_sr_.assign(pixels, 0);
  const Eigen::Matrix3d turn = world_from_probe.toRotationMatrix();
  for (std::size_t bin = 0; bin < grid_.size(); ++bin) {
    if (!(map.solid_angle_sr[bin] > 0)) continue;
    const float part = map.solid_angle_sr[bin] / kPieces;
    const Rgb flux = map.rgb(bin) * part;
    for (std::size_t piece = bin * kPieces; piece < (bin + 1) * kPieces; ++piece) {
      const Vec2d uv = lat_long_from_direction(turn * pieces_[piece]);
      const int x = std::min(static_cast<int>(uv.x() * width_), width_ - 1);
      const int y = std::min(static_cast<int>(uv.y() * height_), height_ - 1);
      out.at(x, y) += flux;
      solid_angle_sr_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                      static_cast<std::size_t>(x)] += part;
    }
  }
  const Eigen::Matrix3d turn_back = turn.transpose();
  for (std::size_t i = 0; i < pixels; ++i) {
    if (solid_angle_sr_[i] > 0) {
      out.pixels[i] /= solid_angle_sr_[i];
      continue;
    }
    const auto x = static_cast<double>(i % static_cast<std::size_t>(width_));
    const auto y = static_cast<double>(i / static_cast<std::size_t>(width_));
    out.pixels[i] =
        seen_toward(map, turn_back * direction_from_lat_long((x + 0.5) / width_, (y + 0.5) / height_));
  }
}

Rgb WorldPicture::seen_toward(const PolarMap& map, const Vec3d& direction) const {
  const Spherical at = spherical_from_direction(direction);
  const int ring = static_cast<int>(at.theta_rad / grid_.theta_max_rad * grid_.rings);
  if (ring >= grid_.rings) return unseen();
  const int sector = std::min(static_cast<int>(at.lambda_rad / (2 * kPi) * grid_.sectors), grid_.sectors - 1);
  const std::size_t bin = static_cast<std::size_t>(ring) * static_cast<std::size_t>(grid_.sectors) +
                          static_cast<std::size_t>(sector);
  return seen_[bin] ? map.rgb(bin) : unseen();
}

}  // namespace lightwell
