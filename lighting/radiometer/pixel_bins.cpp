// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/radiometer/pixel_bins.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "lighting/orientation.h"

namespace lightwell::radiometer {
namespace {

std::uint32_t bin_of(const PolarGrid& grid, const Vec3d& world) {
  const Spherical s = spherical_from_direction(world);
  const int ring = std::min(grid.rings - 1, static_cast<int>(s.theta_rad / grid.theta_max_rad * grid.rings));
  const int sector = std::min(grid.sectors - 1, static_cast<int>(s.lambda_rad / (2 * kPi) * grid.sectors));
  return static_cast<std::uint32_t>(ring) * static_cast<std::uint32_t>(grid.sectors) +
         static_cast<std::uint32_t>(sector);
}

// First and last pixel of a sample along one axis.
struct Extent {
  int first, last;
};
Extent extent(int sample, int size, bool quads) {
  if (!quads) return {sample, sample};
  return {2 * sample, std::min(2 * sample + 1, size - 1)};
}

Vec2d centre(const Lens& lens, int x, int y, bool quads) {
  const Extent ex = extent(x, lens.image_size[0], quads);
  const Extent ey = extent(y, lens.image_size[1], quads);
  return {(ex.first + ex.last) / 2.0, (ey.first + ey.last) / 2.0};
}

double solid_angle(const Lens& lens, int x, int y, bool quads) {
  const Extent ex = extent(x, lens.image_size[0], quads);
  const Extent ey = extent(y, lens.image_size[1], quads);
  double sum = 0;
  for (int v = ey.first; v <= ey.last; ++v)
    for (int u = ex.first; u <= ex.last; ++u) sum += lens.pixel_solid_angle_sr(Vec2d(u, v));
  return sum;
}

// The sample nearest in angle to a direction, among those within two of where it projects; kNone if none sees
// the field.
std::uint32_t nearest_sample(const PixelBins& bins, const Lens& lens, const Vec3d& camera, bool quads) {
  const Vec2d at = lens.project(camera) / (quads ? 2 : 1);
  if (!(at.cwiseAbs().maxCoeff() < 1e6)) return kNone;
  const int cx = static_cast<int>(std::lround(at.x()));
  const int cy = static_cast<int>(std::lround(at.y()));
  const bool sees = cx >= 0 && cy >= 0 && cx < bins.width && cy < bins.height &&
                    bins.group[static_cast<std::size_t>(cy) * static_cast<std::size_t>(bins.width) +
                               static_cast<std::size_t>(cx)] != kNone;
  const int reach = sees ? 1 : 2;
  std::uint32_t best = kNone;
  double best_cosine = -2;
  for (int y = std::max(0, cy - reach); y <= std::min(bins.height - 1, cy + reach); ++y)
    for (int x = std::max(0, cx - reach); x <= std::min(bins.width - 1, cx + reach); ++x) {
      const auto sample = static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(bins.width) +
                          static_cast<std::uint32_t>(x);
      if (bins.group[sample] == kNone) continue;
      const double cosine = lens.unproject(centre(lens, x, y, quads)).dot(camera);
      if (cosine > best_cosine) {
        best = sample;
        best_cosine = cosine;
      }
    }
  return best;
}

// Bins that look past the image take over from their neighbours, ring by ring outward from those that are
// known.
void spread_nearest(const PolarGrid& grid, const std::vector<std::uint32_t>& own,
                    std::vector<std::uint32_t>& nearest) {
  const auto rings = static_cast<std::uint32_t>(grid.rings);
  const auto sectors = static_cast<std::uint32_t>(grid.sectors);
  const auto known = [&](std::uint32_t b) { return own[b] != kNone ? own[b] : nearest[b]; };
  std::vector<std::uint32_t> front;
  for (std::uint32_t b = 0; b < own.size(); ++b)
    if (known(b) != kNone) front.push_back(b);
  for (std::size_t next = 0; next < front.size(); ++next) {
    const std::uint32_t ring = front[next] / sectors;
    const std::uint32_t sector = front[next] % sectors;
    const std::uint32_t row = ring * sectors;
    const std::uint32_t neighbours[4] = {row + (sector + 1) % sectors, row + (sector + sectors - 1) % sectors,
                                         ring > 0 ? front[next] - sectors : front[next],
                                         ring + 1 < rings ? front[next] + sectors : front[next]};
    for (const std::uint32_t n : neighbours) {
      if (known(n) != kNone) continue;
      nearest[n] = known(front[next]);
      front.push_back(n);
    }
  }
}

// Samples below a quarter of their bin's largest, quarter by quarter, into groups of their own.
void split_groups(PixelBins& bins) {
  std::vector<float> largest(bins.bin_sr.size(), 0);
  for (std::size_t s = 0; s < bins.group.size(); ++s)
    if (bins.group[s] != kNone)
      largest[bins.group[s]] = std::max(largest[bins.group[s]], bins.solid_angle_sr[s]);
  bins.bin_of_group.resize(bins.bin_sr.size());
  std::iota(bins.bin_of_group.begin(), bins.bin_of_group.end(), 0u);
  std::map<std::pair<std::uint32_t, int>, std::uint32_t> group_of;  // (bin, quarters) of the few slivers
  for (std::size_t s = 0; s < bins.group.size(); ++s) {
    const std::uint32_t bin = bins.group[s];
    if (bin == kNone || 4 * bins.solid_angle_sr[s] >= largest[bin]) continue;
    const int quarters = static_cast<int>(std::log2(largest[bin] / bins.solid_angle_sr[s]) / 2);
    const auto next = static_cast<std::uint32_t>(bins.bin_of_group.size());
    const auto [found, fresh] = group_of.try_emplace({bin, quarters}, next);
    if (fresh) bins.bin_of_group.push_back(bin);
    bins.group[s] = found->second;
  }
}

}  // namespace

Result<PixelBins> bin_pixels(const Lens& lens_of_camera, const PolarGrid& grid, bool quads) {
  Lens lens = lens_of_camera;
  const Eigen::Matrix3d world_from_camera = world_from_camera_rotation(lens.zenith);
  // The border of a level camera's grid is a circle in its image, and cuts pixels as the lens's own does; that of a
  // tilted one takes or leaves them whole.
  const bool level = lens.zenith == Vec3d::UnitZ();
  if (level) lens.max_theta_rad = std::min(lens.max_theta_rad, grid.theta_max_rad);
  const double lowest = std::cos(grid.theta_max_rad);
  const int step = quads ? 2 : 1;
  PixelBins bins;
  bins.width = (lens.image_size[0] + step - 1) / step;
  bins.height = (lens.image_size[1] + step - 1) / step;
  const std::size_t samples = static_cast<std::size_t>(bins.width) * static_cast<std::size_t>(bins.height);
  bins.group.assign(samples, kNone);
  bins.solid_angle_sr.assign(samples, 0);
  bins.bin_sr.assign(grid.size(), 0);
  std::vector<std::uint32_t> own(grid.size(), kNone);  // some sample of the bin
  std::uint32_t sample = 0;
  for (int y = 0; y < bins.height; ++y)
    for (int x = 0; x < bins.width; ++x, ++sample) {
      const auto omega = static_cast<float>(solid_angle(lens, x, y, quads));
      // A sliver of the border this thin is rounding of the quadrature, below a photon's worth of any pixel.
      if (!(omega > 1e-12f)) continue;
      const Vec3d world = world_from_camera * lens.unproject(centre(lens, x, y, quads));
      if (!level && world.y() < lowest) continue;
      const std::uint32_t bin = bin_of(grid, world);
      bins.group[sample] = bin;
      bins.solid_angle_sr[sample] = omega;
      bins.bin_sr[bin] += static_cast<double>(omega);
      bins.total_sr += static_cast<double>(omega);
      own[bin] = sample;
    }
  if (!(bins.total_sr > 0))
    return Error{ErrorKind::bad_input, "lens.center: no pixel of the image sees the field of view"};
  bins.nearest.assign(grid.size(), kNone);
  for (std::uint32_t bin = 0; bin < own.size(); ++bin)
    if (own[bin] == kNone) {
      const auto sectors = static_cast<std::uint32_t>(grid.sectors);
      const Vec3d world =
          grid.bin_direction(static_cast<int>(bin / sectors), static_cast<int>(bin % sectors));
      bins.nearest[bin] = nearest_sample(bins, lens, world_from_camera.transpose() * world, quads);
    }
  spread_nearest(grid, own, bins.nearest);
  split_groups(bins);
  return bins;
}

}  // namespace lightwell::radiometer
