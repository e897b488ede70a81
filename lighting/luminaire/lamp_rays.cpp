// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/luminaire/lamp_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "lighting/result.h"

namespace lightwell {
namespace {

// Rays that run flatter than this are not the near field's: they cross the sampling plane far away.
constexpr double kLeastDrop = 0.03;
constexpr double kOutside = 0.0005;  // of the flux at each end of the positions
// A lamp as wide, in spacings, as this or less is one row in its middle: two, half a spacing beside it, are the worse
// likeness. The variance of its light across is off by w²/12, of two rows by 1/4 − w²/12.
constexpr double kRowWidth = 1.22;
constexpr double kPoint_m = 1e-9;  // smaller lamps are points
constexpr int kRestPlanes = 24, kRestAngles = 36;

struct Weighted {
  double value, weight;
};
double quantile(std::vector<Weighted>& values, double part) {
  std::sort(values.begin(), values.end(),
            [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
  double total = 0, sum = 0;
  for (const Weighted& v : values) total += v.weight;
  for (const Weighted& v : values)
    if ((sum += v.weight) >= part * total) return v.value;
  return values.back().value;
}

// Two neighbours and the second one's share, for a place on a grid of this many; beyond its ends the last.
struct Neighbours {
  std::array<int, 2> at;
  std::array<double, 2> share;
};
Neighbours neighbours(double place, int count) {
  const double inside = std::clamp(place, 0.0, count - 1.0);
  const int low = std::min(static_cast<int>(inside), std::max(count - 2, 0));
  const double part = count > 1 ? inside - low : 0;
  return {{low, std::min(low + 1, count - 1)}, {1 - part, part}};
}

// Where near rays cross the sampling plane.
Vec2d crossing(const LampRay& ray, double z_m) {
  const Vec3d at = ray.origin_m + ray.direction * ((z_m - ray.origin_m.z()) / ray.direction.z());
  return at.head<2>();
}

// Where near rays cross the sampling plane: nearly all of them, and their mean by flux.
struct Extent {
  Vec2d low = Vec2d::Zero(), high = Vec2d::Zero(), mean = Vec2d::Zero();
};
Extent extent_of(std::span<const LampRay> rays, double z_m) {
  Extent extent;
  for (int axis = 0; axis < 2; ++axis) {
    std::vector<Weighted> places;
    for (const LampRay& ray : rays)
      if (ray.direction.z() < -kLeastDrop) places.push_back({crossing(ray, z_m)[axis], ray.flux_lm});
    if (places.empty()) break;
    extent.low[axis] = quantile(places, kOutside);
    extent.high[axis] = quantile(places, 1 - kOutside);
    double flux = 0, sum = 0;
    for (const Weighted& place : places) {
      sum += place.weight * std::clamp(place.value, extent.low[axis], extent.high[axis]);
      flux += place.weight;
    }
    extent.mean[axis] = sum / flux;
  }
  return extent;
}

// The finest square grid of no more than positions² that spans the longer side exactly: a long lamp has its positions along
// it, where they are needed, and not the length's coarse spacing for both sides.
void lay_grid(const Extent& extent, int positions, LampPlanes& planes) {
  const Vec2d size = extent.high - extent.low;
  const int longer = size.y() > size.x() ? 1 : 0, shorter = 1 - longer;
  if (!(size[longer] > kPoint_m)) {
    planes.first_m = extent.mean;
    planes.spacing_m = 1e-3;
    return;
  }
  std::array<int, 2> count{};
  for (int along = positions * positions; along >= positions; --along) {
    planes.spacing_m = size[longer] / (along - 1);
    const double across = size[shorter] / planes.spacing_m;
    const bool long_row = across <= std::min(kRowWidth, (along - 1) / 2.0);
    const int rows = long_row ? 1 : static_cast<int>(std::ceil(across - 1e-9)) + 1;
    count = longer == 0 ? std::array{along, rows} : std::array{rows, along};
    if (along * rows <= positions * positions) break;  // positions × positions at the latest
  }
  planes.positions = count;
  for (int axis = 0; axis < 2; ++axis) {
    const int last = count[static_cast<std::size_t>(axis)] - 1;
    const double middle = last == 0 ? extent.mean[axis] : (extent.low[axis] + extent.high[axis]) / 2;
    planes.first_m[axis] = middle - last / 2.0 * planes.spacing_m;
  }
}

LampPlanes planes_of(std::span<const LampRay> rays, const RayBinning& options) {
  LampPlanes planes;
  planes.map = LampMap::hemisphere;
  planes.low_m = Vec2d::Constant(-1);
  planes.high_m = Vec2d::Constant(1);
  const int side = options.pixels > 0 ? options.pixels : pixels_for(rays.size());
  planes.pixels = {side, side};
  std::vector<Weighted> heights;
  for (const LampRay& ray : rays) heights.push_back({ray.origin_m.z(), ray.flux_lm});
  planes.z_m = quantile(heights, 0.5);
  lay_grid(extent_of(rays, planes.z_m), options.positions, planes);
  return planes;
}

// Adds flux where images hold intensity: the division by solid angle comes last.
void add_near(LampImages& flux, const LampRay& ray) {
  const LampPlanes& planes = flux.planes;
  const Vec2d at = (crossing(ray, planes.z_m) - planes.first_m) / planes.spacing_m;
  const Vec2d pixel =
      (square_from_direction(ray.direction) - planes.low_m).cwiseQuotient(planes.pixel_m()).array() - 0.5;
  const Neighbours u = neighbours(at.x(), planes.positions[0]), v = neighbours(at.y(), planes.positions[1]);
  const Neighbours s = neighbours(pixel.x(), planes.pixels[0]), t = neighbours(pixel.y(), planes.pixels[1]);
  for (std::size_t j = 0; j < 2; ++j)
    for (std::size_t i = 0; i < 2; ++i) {
      const double share = u.share[i] * v.share[j] * ray.flux_lm;
      if (share == 0) continue;
      Rgb* image = flux.image(u.at[i], v.at[j]);
      for (std::size_t y = 0; y < 2; ++y)
        for (std::size_t x = 0; x < 2; ++x)
          image[t.at[y] * planes.pixels[0] + s.at[x]] += static_cast<float>(share * s.share[x] * t.share[y]);
    }
}

// A table with all flux in one node of it at a time has this flux a candela.
std::vector<double> node_solid_angles(FarField table) {
  std::vector<double> angles;
  for (std::size_t v = 0; v < table.vertical_deg.size(); ++v) {
    std::fill(table.candela.begin(), table.candela.end(), 0.0);
    table.at(0, v) = 1;  // planes are alike
    angles.push_back(luminous_flux(table));
  }
  return angles;
}

}  // namespace

int pixels_for(std::size_t rays) {
  constexpr double kRaysAPixel = 150;
  return static_cast<int>(
      std::clamp(std::round(std::sqrt(static_cast<double>(rays) / kRaysAPixel)), 16.0, 128.0));
}

Luminaire bin_rays(std::span<const LampRay> rays, const RayBinning& options) {
  verify_bug(!rays.empty() && options.positions >= 2 && (options.pixels == 0 || options.pixels >= 2),
             "nothing to bin, or no bins");
  Luminaire lamp;
  LampImages& images = lamp.near.emplace().intensity;
  images.planes = planes_of(rays, options);
  images.values.assign(images.planes.images() * images.planes.image_size(), Rgb::Zero());
  FarField& rest = lamp.far.emplace();
  rest.horizontal_deg.clear();
  for (int h = 0; h < kRestPlanes; ++h) rest.horizontal_deg.push_back(360.0 * h / kRestPlanes);
  for (int v = 0; v <= kRestAngles; ++v) rest.vertical_deg.push_back(180.0 * v / kRestAngles);
  rest.candela.assign(rest.horizontal_deg.size() * rest.vertical_deg.size(), 0.0);
  for (const LampRay& ray : rays) {
    if (ray.direction.z() < -kLeastDrop) {
      add_near(images, ray);
      continue;
    }
    const PhotometricAngles angles = photometric_angles(PhotometricSystem::c, ray.direction);
    const auto h = static_cast<std::size_t>(std::lround(angles.horizontal_deg / 360 * kRestPlanes)) %
                   static_cast<std::size_t>(kRestPlanes);
    rest.at(h, static_cast<std::size_t>(std::lround(angles.vertical_deg / 180 * kRestAngles))) += ray.flux_lm;
  }
  const auto per_pixel = static_cast<float>(1 / images.planes.pixel_solid_angle_sr(Vec2d::Zero(), 0, 0));
  for (Rgb& value : images.values) value *= per_pixel;
  const std::vector<double> angles = node_solid_angles(rest);
  for (std::size_t h = 0; h < rest.horizontal_deg.size(); ++h)
    for (std::size_t v = 0; v < rest.vertical_deg.size(); ++v) rest.at(h, v) /= angles[v];
  return lamp;
}

double nearest_m(const LampPlanes& planes) {
  constexpr double kSpacings = 2;
  return kSpacings * planes.spacing_m;
}

}  // namespace lightwell
