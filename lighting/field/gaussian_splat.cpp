// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/gaussian_splat.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

namespace lightwell {
namespace {

// One resolution of the pyramid: radiance where weight is above 0.
struct Level {
  int width = 0, height = 0;
  std::vector<Eigen::Array3f> radiance;
  std::vector<float> weight;
  Level(int w, int h)
      : width(w),
        height(h),
        radiance(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), Eigen::Array3f::Zero()),
        weight(radiance.size(), 0.0f) {}
  [[nodiscard]] std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

void splat(const ShearPlane& plane, const PlaneSample& sample, const Eigen::Matrix2d& pixel_from_across,
           Level& level) {
  const Vec2d at = sample.at.cast<double>();
  const Vec2d middle = pixel_from_across * at;
  // The kernel's disc is an ellipse in pixels, and this the box around it.
  const double reach_x = kNearCells * pixel_from_across.row(0).norm();
  const double reach_y = kNearCells * pixel_from_across.row(1).norm();
  if (!(middle.x() + reach_x >= 0 && middle.x() - reach_x <= level.width - 1 && middle.y() + reach_y >= 0 &&
        middle.y() - reach_y <= level.height - 1))
    return;
  const int x0 = std::max(0, static_cast<int>(std::ceil(middle.x() - reach_x)));
  const int x1 = std::min(level.width - 1, static_cast<int>(std::floor(middle.x() + reach_x)));
  const int y0 = std::max(0, static_cast<int>(std::ceil(middle.y() - reach_y)));
  const int y1 = std::min(level.height - 1, static_cast<int>(std::floor(middle.y() + reach_y)));
  constexpr double kInverseVariance = 1 / (kSplatSigmaCells * kSplatSigmaCells);
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const double square = (plane.across(Vec2d(x, y)) - at).squaredNorm();
      if (square > kNearCells * kNearCells) continue;
      const auto weight = static_cast<float>(std::exp(-0.5 * kInverseVariance * square));
      const std::size_t i = level.at(x, y);
      level.radiance[i] += weight * sample.radiance;
      level.weight[i] += weight;
    }
}

// Box filter over what is known.
Level half_of(const Level& fine) {
  Level coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x)
      if (fine.weight[fine.at(x, y)] > 0) {
        coarse.radiance[coarse.at(x / 2, y / 2)] += fine.radiance[fine.at(x, y)];
        coarse.weight[coarse.at(x / 2, y / 2)] += 1;
      }
  for (std::size_t i = 0; i < coarse.weight.size(); ++i)
    if (coarse.weight[i] > 0) coarse.radiance[i] /= coarse.weight[i];
  return coarse;
}

// Linear interpolation of those of the four pixels around a place that are known; false where none is.
bool interpolate(const Level& level, double x, double y, Eigen::Array3f& value) {
  const double left = std::floor(x), top = std::floor(y);
  Eigen::Array3f sum = Eigen::Array3f::Zero();
  float weight = 0;
  for (int dy = 0; dy < 2; ++dy)
    for (int dx = 0; dx < 2; ++dx) {
      const int px = std::clamp(static_cast<int>(left) + dx, 0, level.width - 1);
      const int py = std::clamp(static_cast<int>(top) + dy, 0, level.height - 1);
      const std::size_t i = level.at(px, py);
      if (level.weight[i] <= 0) continue;
      const auto w = static_cast<float>((1 - std::abs(x - left - dx)) * (1 - std::abs(y - top - dy)));
      sum += w * level.radiance[i];
      weight += w;
    }
  if (weight <= 0) return false;
  value = sum / weight;
  return true;
}

void repair(Level& level) {
  std::vector<Level> coarser;
  std::vector<Eigen::Array3f> repaired = level.radiance;
  for (int y = 0; y < level.height; ++y)
    for (int x = 0; x < level.width; ++x) {
      if (level.weight[level.at(x, y)] > 0) continue;
      for (std::size_t l = 0;; ++l) {
        if (l == coarser.size()) coarser.push_back(half_of(l == 0 ? level : coarser.back()));
        const double scale = std::ldexp(1.0, -static_cast<int>(l) - 1);
        if (interpolate(coarser[l], (x + 0.5) * scale - 0.5, (y + 0.5) * scale - 0.5,
                        repaired[level.at(x, y)]))
          break;
        if (coarser[l].width == 1 && coarser[l].height == 1) break;  // no ray anywhere
      }
    }
  level.radiance = std::move(repaired);
}

}  // namespace

void gaussian_splat(const ShearPlane& plane, std::span<const PlaneSample> samples, PlaneImage& image) {
  image.resize(plane.width(), plane.height());
  Eigen::Matrix2d across_from_pixel;
  across_from_pixel << plane.across(Vec2d::UnitX()), plane.across(Vec2d::UnitY());
  const Eigen::Matrix2d pixel_from_across = across_from_pixel.inverse();
  Level level(image.width, image.height);
  for (const PlaneSample& sample : samples) splat(plane, sample, pixel_from_across, level);
  for (std::size_t i = 0; i < level.weight.size(); ++i)
    if (level.weight[i] > 0) level.radiance[i] /= level.weight[i];
  repair(level);
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    for (int c = 0; c < 3; ++c) image.channel(c)[i] = level.radiance[i][c];
    image.channel(3)[i] = level.weight[i] > 0 ? 1.0f : 0.0f;
  }
}

}  // namespace lightwell
