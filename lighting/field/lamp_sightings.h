// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "lighting/field/polar_cells.h"
#include "lighting/map_harmonics.h"

namespace lightwell {

// A small bright lamp as one probe sees it: what stands out of its surroundings.
struct LampSighting {
  Vec3d direction = Vec3d::UnitY();                         // its centre of light, unit
  Rgbd illuminance = Rgbd::Zero();                          // lux facing it, above the surroundings
  double angular_radius_rad = 0;                            // of an even disc as wide
  double reach_rad = 0;                                     // its farthest light from direction
  Rgb surroundings = Rgb::Zero();                           // radiance that would be there without it
  RadianceHarmonics harmonics = RadianceHarmonics::Zero();  // its part of the map's
  struct Share {
    std::uint32_t cell;
    Rgb radiance;  // its part of the cell's mean radiance
  };
  std::vector<Share> shares;
};

// Finds lamps in polar maps as astronomers measure stars: the brightest bin, the smallest circle around it beyond which the
// light no longer falls, the median of a ring around that as the surroundings, and what stands above them around the peak. A lamp has six times the surroundings'
// luminance, a fiftieth of the map's light, and a circle of less than 30°; wider lights are no lamps.
// source: Stetson 1987, "DAOPHOT: a computer program for crowded-field stellar photometry", section III
class LampFinder {
 public:
  static constexpr std::size_t kMostLamps = 8;
  explicit LampFinder(const PolarCells& cells);  // that outlive this

  // Brightest peak first, at most kMostLamps. The map is of the cells' grid; values that are not finite are left out.
  void find(const PolarMap& map, std::vector<LampSighting>& lamps);

 private:
  struct Circle {
    double radius_rad;
    double around;  // median luminance beyond it
    bool ends;      // the lamp: it stands out of its surroundings, which fall no more
  };
  double load(const PolarMap& map);
  Circle circle_around(const Vec3f& centre, double peak);
  [[nodiscard]] Rgb background(const PolarMap& map, double around) const;
  double measure(const PolarMap& map, const Rgb& background, LampSighting& lamp) const;
  void take(const Vec3f& centre, double radius_rad);
  void collect(const Vec3f& centre, double inner_rad, double outer_rad,
               std::vector<std::uint32_t>& bins) const;
  bool flood(std::uint32_t peak, float least, const Vec3f& centre);
  double dark_level();
  double surroundings(std::span<const std::uint32_t> bins);
  void update_peaks(const Vec3f& centre, double radius_rad);
  const PolarCells& cells_;
  std::vector<Vec3f> directions_;        // [bins]
  std::vector<float> ring_solid_angle_;  // [rings]
  std::vector<float> luminance_;         // [bins], below 0 where taken or not finite
  std::vector<std::uint32_t> peak_;      // [rings], the brightest bin of each
  std::vector<std::uint32_t> ring_, aperture_;
  std::vector<char> in_aperture_;
  std::vector<float> sorted_;
};

}  // namespace lightwell
