// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/splat_in_space.h"

#include <algorithm>
#include <cmath>

#include "lighting/field/gaussian_splat.h"

namespace lightwell::bench {

SplatInSpace::SplatInSpace(const FieldGrid& grid, int degree) {
  field_.grid = grid;
  field_.degree = degree;
  field_.radiance.assign(grid.points() * 3 * static_cast<std::size_t>(harmonic_count(degree)), 0);
  field_.confidence.assign(grid.points(), 0);
  volume_ = {grid.size, std::vector<Rgb>(grid.points()), std::vector<float>(grid.points())};
}

// Slice by slice across the axis that the ray runs along most: in each the kernel is a box of points around the ray.
void SplatInSpace::project(const Vec3d& through, const Vec3d& along, const Rgb& radiance) {
  int main = 0;
  along.cwiseAbs().maxCoeff(&main);
  const int a = (main + 1) % 3, b = (main + 2) % 3;
  const double reach = kNearCells / std::abs(along[main]);
  const auto size = [&](int axis) { return volume_.size[static_cast<std::size_t>(axis)]; };
  for (int slice = 0; slice < size(main); ++slice) {
    const Vec3d middle = through + along * ((slice - through[main]) / along[main]);
    const int a0 = std::max(0, static_cast<int>(std::ceil(middle[a] - reach)));
    const int a1 = std::min(size(a) - 1, static_cast<int>(std::floor(middle[a] + reach)));
    const int b0 = std::max(0, static_cast<int>(std::ceil(middle[b] - reach)));
    const int b1 = std::min(size(b) - 1, static_cast<int>(std::floor(middle[b] + reach)));
    for (int j = b0; j <= b1; ++j)
      for (int i = a0; i <= a1; ++i) {
        Eigen::Vector3i point;
        point[main] = slice;
        point[a] = i;
        point[b] = j;
        const Vec3d offset = point.cast<double>() - middle;
        const double along_ray = offset.dot(along);
        const double square = offset.squaredNorm() - along_ray * along_ray;
        if (square > kNearCells * kNearCells) continue;
        const auto weight =
            static_cast<float>(std::exp(-0.5 * square / (kSplatSigmaCells * kSplatSigmaCells)));
        const std::size_t at = volume_.at(point.x(), point.y(), point.z());
        volume_.radiance[at] += weight * radiance;
        volume_.weight[at] += weight;
      }
  }
}

SplatInSpace::Level SplatInSpace::half_of(const Level& fine) {
  const std::array<int, 3> size = {(fine.size[0] + 1) / 2, (fine.size[1] + 1) / 2, (fine.size[2] + 1) / 2};
  const auto points = static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
                      static_cast<std::size_t>(size[2]);
  Level coarse{size, std::vector<Rgb>(points, Rgb::Zero()), std::vector<float>(points, 0.0f)};
  for (int z = 0; z < fine.size[2]; ++z)
    for (int y = 0; y < fine.size[1]; ++y)
      for (int x = 0; x < fine.size[0]; ++x)
        if (fine.weight[fine.at(x, y, z)] > 0) {
          coarse.radiance[coarse.at(x / 2, y / 2, z / 2)] += fine.radiance[fine.at(x, y, z)];
          coarse.weight[coarse.at(x / 2, y / 2, z / 2)] += 1;
        }
  for (std::size_t i = 0; i < points; ++i)
    if (coarse.weight[i] > 0) coarse.radiance[i] /= coarse.weight[i];
  return coarse;
}

bool SplatInSpace::interpolate(const Level& level, const Vec3d& at, Rgb& value) {
  const Vec3d base = at.array().floor();
  Rgb sum = Rgb::Zero();
  float weight = 0;
  for (int corner = 0; corner < 8; ++corner) {
    std::array<int, 3> p;
    double w = 1;
    for (int a = 0; a < 3; ++a) {
      const int step = corner >> a & 1;
      p[static_cast<std::size_t>(a)] =
          std::clamp(static_cast<int>(base[a]) + step, 0, level.size[static_cast<std::size_t>(a)] - 1);
      w *= 1 - std::abs(at[a] - base[a] - step);
    }
    const std::size_t i = level.at(p[0], p[1], p[2]);
    if (level.weight[i] <= 0) continue;
    sum += static_cast<float>(w) * level.radiance[i];
    weight += static_cast<float>(w);
  }
  if (weight <= 0) return false;
  value = sum / weight;
  return true;
}

void SplatInSpace::repair() {
  std::vector<Level> coarser;
  std::vector<Rgb> repaired = volume_.radiance;
  for (int z = 0; z < volume_.size[2]; ++z)
    for (int y = 0; y < volume_.size[1]; ++y)
      for (int x = 0; x < volume_.size[0]; ++x) {
        if (volume_.weight[volume_.at(x, y, z)] > 0) continue;
        for (std::size_t l = 0;; ++l) {
          if (l == coarser.size()) coarser.push_back(half_of(l == 0 ? volume_ : coarser.back()));
          const double scale = std::ldexp(1.0, -static_cast<int>(l) - 1);
          const Vec3d at = (Vec3d(x, y, z).array() + 0.5) * scale - 0.5;
          if (interpolate(coarser[l], at, repaired[volume_.at(x, y, z)])) break;
          if (coarser[l].radiance.size() == 1) break;  // no ray anywhere
        }
      }
  volume_.radiance = std::move(repaired);
}

void SplatInSpace::add(const MeasuredDirection& direction, std::span<const Vec3d> positions,
                       std::span<const Rgb> radiance, const Eigen::VectorXf& harmonics) {
  const FieldGrid& grid = field_.grid;
  std::fill(volume_.radiance.begin(), volume_.radiance.end(), Rgb::Zero());
  std::fill(volume_.weight.begin(), volume_.weight.end(), 0.0f);
  const Vec3d along = direction.direction.cwiseQuotient(grid.cell()).normalized();
  for (std::size_t i = 0; i < positions.size(); ++i)
    project(grid.grid_from_world(positions[i] + direction.origin), along, radiance[i]);
  for (std::size_t i = 0; i < volume_.weight.size(); ++i)
    if (volume_.weight[i] > 0) volume_.radiance[i] /= volume_.weight[i];
  repair();
  const std::size_t slab = field_.slab_points();
  for (int z = 0; z < grid.size[2]; ++z)
    for (int h = 0; h < field_.harmonics(); ++h)
      for (int c = 0; c < 3; ++c) {
        float* out = field_.plane(z, h, c);
        const Rgb* light = volume_.radiance.data() + static_cast<std::size_t>(z) * slab;
        for (std::size_t i = 0; i < slab; ++i) out[i] += harmonics[h] * light[i][c];
      }
}

}  // namespace lightwell::bench
