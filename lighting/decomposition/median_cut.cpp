// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/median_cut.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "lighting/decomposition/lit_bins.h"

namespace lightwell {
namespace {

struct Region {
  int ring0, ring1;
  int sector0, sector1;
  double luminance;
};

// Luminance below and left of every bin's corner: any rectangle is four look-ups (Crow 1984).
class SummedArea {
 public:
  SummedArea(const PolarMap& map, int seam) : sectors_(static_cast<std::size_t>(map.grid.sectors)) {
    const auto rings = static_cast<std::size_t>(map.grid.rings);
    table_.assign((rings + 1) * (sectors_ + 1), 0.0);
    for (std::size_t ring = 0; ring < rings; ++ring) {
      double row = 0;
      for (std::size_t sector = 0; sector < sectors_; ++sector) {
        row += luminance(
            bin_illuminance(map, ring * sectors_ + (sector + static_cast<std::size_t>(seam)) % sectors_));
        table_[(ring + 1) * (sectors_ + 1) + sector + 1] = table_[ring * (sectors_ + 1) + sector + 1] + row;
      }
    }
  }
  [[nodiscard]] double sum(int ring0, int ring1, int sector0, int sector1) const {
    return std::max(0.0, at(ring1, sector1) - at(ring0, sector1) - at(ring1, sector0) + at(ring0, sector0));
  }

 private:
  [[nodiscard]] double at(int ring, int sector) const {
    return table_[static_cast<std::size_t>(ring) * (sectors_ + 1) + static_cast<std::size_t>(sector)];
  }
  std::size_t sectors_;
  std::vector<double> table_;
};

// The sector opposite the light's mean azimuth, so that the cuts that every map begins with, its edges, pass where
// little light is; that of the image's own edges (λ = π) where light has no azimuth to speak of.
int seam_of(const PolarMap& map) {
  constexpr double kLeastLean = 0.01;  // of the total: noise of a few per cent a bin turns nothing
  const PolarGrid& grid = map.grid;
  std::vector<double> column(static_cast<std::size_t>(grid.sectors), 0.0);
  double total = 0;
  std::size_t bin = 0;
  for (int ring = 0; ring < grid.rings; ++ring) {
    const double sine = std::sin(grid.theta_max_rad * (ring + 0.5) / grid.rings);
    for (double& sum : column) {
      const double power = luminance(bin_illuminance(map, bin++));
      sum += sine * power;
      total += power;
    }
  }
  double x = 0;
  double z = 0;
  for (int sector = 0; sector < grid.sectors; ++sector) {
    const double lambda = 2 * kPi * (sector + 0.5) / grid.sectors;
    x += column[static_cast<std::size_t>(sector)] * std::sin(lambda);
    z += column[static_cast<std::size_t>(sector)] * std::cos(lambda);
  }
  if (!(std::hypot(x, z) > kLeastLean * total)) return grid.sectors / 2;
  const double turns = spherical_from_direction({-x, 0, -z}).lambda_rad / (2 * kPi);
  return static_cast<int>(std::lround(turns * grid.sectors)) % grid.sectors;
}

class MedianCut {
 public:
  explicit MedianCut(const PolarMap& map) : map_(map), seam_(seam_of(map)), area_(map, seam_) {}

  std::vector<DirectionalLight> lights(int count) {
    divide(static_cast<std::size_t>(count));
    std::vector<DirectionalLight> lights;
    for (std::size_t i = 0; i < regions_.size(); ++i) {
      lights.push_back(light(regions_[i]));
      lights.back().parent = parents_[i];
    }
    DirectionalLight dark = lights.front();
    dark.illuminance = Rgb::Zero();
    dark.parent = 0;
    lights.resize(static_cast<std::size_t>(count), dark);
    return lights;
  }

 private:
  void divide(std::size_t count) {
    const PolarGrid& grid = map_.grid;
    regions_ = {{0, grid.rings, 0, grid.sectors, area_.sum(0, grid.rings, 0, grid.sectors)}};
    parents_ = {-1};
    for (bool grew = true; grew && regions_.size() < count;) {
      grew = false;
      std::vector<std::size_t> round(regions_.size());
      for (std::size_t i = 0; i < round.size(); ++i) round[i] = i;
      std::stable_sort(round.begin(), round.end(), [&](std::size_t a, std::size_t b) {
        return regions_[a].luminance > regions_[b].luminance;
      });
      for (const std::size_t i : round) {
        if (regions_.size() == count) break;
        const auto halves = halve(regions_[i]);
        if (!halves) continue;
        regions_[i] = halves->first;
        regions_.push_back(halves->second);
        parents_.push_back(static_cast<std::int32_t>(i));
        grew = true;
      }
    }
  }

  // The brighter half first.
  [[nodiscard]] std::optional<std::pair<Region, Region>> halve(const Region& region) const {
    if (!(region.luminance > 0)) return std::nullopt;
    const int rings = region.ring1 - region.ring0;
    const int sectors = region.sector1 - region.sector0;
    if (rings * static_cast<std::int64_t>(sectors) < 2) return std::nullopt;
    const PolarGrid& grid = map_.grid;
    const double middle = grid.theta_max_rad * (region.ring0 + region.ring1) / (2.0 * grid.rings);
    const double height = grid.theta_max_rad * rings / grid.rings;
    const double width = 2 * kPi * sectors / grid.sectors * std::sin(middle);
    const bool across_rings = sectors == 1 || (rings > 1 && height >= width);
    const auto first_part = [&](int at) {
      Region part = region;
      (across_rings ? part.ring1 : part.sector1) = at;
      part.luminance = area_.sum(part.ring0, part.ring1, part.sector0, part.sector1);
      return part;
    };
    // The first edge past half the luminance, or the one before it, whichever is nearer.
    int low = (across_rings ? region.ring0 : region.sector0) + 1;
    const int end = (across_rings ? region.ring1 : region.sector1) - 1;
    int high = end;
    while (low < high) {
      const int at = (low + high) / 2;
      if (first_part(at).luminance >= region.luminance / 2) {
        high = at;
      } else {
        low = at + 1;
      }
    }
    const auto unevenness = [&](int at) { return std::abs(2 * first_part(at).luminance - region.luminance); };
    const int first = (across_rings ? region.ring0 : region.sector0) + 1;
    if (low > first && unevenness(low - 1) < unevenness(low)) --low;
    const Region a = first_part(low);
    Region b = region;
    (across_rings ? b.ring0 : b.sector0) = low;
    b.luminance = area_.sum(b.ring0, b.ring1, b.sector0, b.sector1);
    return a.luminance >= b.luminance ? std::pair{a, b} : std::pair{b, a};
  }

  [[nodiscard]] DirectionalLight light(const Region& region) const {
    const PolarGrid& grid = map_.grid;
    Vec3d moment = Vec3d::Zero();
    Rgbd illuminance = Rgbd::Zero();
    for (int ring = region.ring0; ring < region.ring1; ++ring)
      for (int place = region.sector0; place < region.sector1; ++place) {
        const int sector = (place + seam_) % grid.sectors;
        const Rgbd value =
            bin_illuminance(map_, static_cast<std::size_t>(ring) * static_cast<std::size_t>(grid.sectors) +
                                      static_cast<std::size_t>(sector));
        const double weight = luminance(value);
        if (!(weight > 0)) continue;
        moment += weight * grid.bin_direction(ring, sector);
        illuminance += value;
      }
    DirectionalLight light;
    light.illuminance = illuminance.cast<float>();
    const double length = moment.norm();
    // Dark regions, and whole spheres whose light cancels, are shown by their middle.
    const Vec3d middle =
        direction_from_spherical({grid.theta_max_rad * (region.ring0 + region.ring1) / (2.0 * grid.rings),
                                  kPi * (region.sector0 + region.sector1 + 2 * seam_) / grid.sectors});
    light.direction =
        (length > 1e-9 * luminance(illuminance) ? Vec3d(moment / length) : middle).cast<float>();
    return light;
  }

  const PolarMap& map_;
  int seam_;  // the sector that regions are counted from
  SummedArea area_;
  std::vector<Region> regions_;
  std::vector<std::int32_t> parents_;
};

}  // namespace

std::vector<DirectionalLight> median_cut(const PolarMap& map, int count) {
  return MedianCut(map).lights(count);
}

}  // namespace lightwell
