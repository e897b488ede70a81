// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/lamp_sightings.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lightwell {
namespace {

constexpr double kDegree = kPi / 180;
constexpr double kFirstRadius = 2 * kDegree, kLastRadius = 30 * kDegree, kGrowth = 1.3;
constexpr double kContrast = 6;           // of the peak over the surroundings
constexpr double kThinned = 4 * kDegree;  // a ring of this radius has more bins than its median needs
constexpr double kStillFalling = 0.8;     // surroundings of a wider circle below this: the lamp goes on
constexpr double kEdge = 0.05;            // of the peak over the surroundings: what belongs to the lamp
constexpr double kLeastShare = 0.02;      // of the map's light
constexpr float kTaken = -1;

}  // namespace

LampFinder::LampFinder(const PolarCells& cells)
    : cells_(cells), luminance_(cells.grid().size()), in_aperture_(luminance_.size()) {
  const PolarGrid& grid = cells.grid();
  for (int ring = 0; ring < grid.rings; ++ring) {
    ring_solid_angle_.push_back(static_cast<float>(grid.bin_solid_angle_sr(ring)));
    for (int sector = 0; sector < grid.sectors; ++sector)
      directions_.push_back(grid.bin_direction(ring, sector).cast<float>());
  }
  peak_.resize(static_cast<std::size_t>(grid.rings));
}

// Bins whose centres lie between two angles from a direction, taken ones left out. Of a wide ring, whose median is all
// that is asked, every n-th row and column are enough.
void LampFinder::collect(const Vec3f& centre, double inner_rad, double outer_rad,
                         std::vector<std::uint32_t>& bins) const {
  bins.clear();
  const PolarGrid& grid = cells_.grid();
  const Spherical at = spherical_from_direction(centre.cast<double>());
  const double ring_rad = grid.theta_max_rad / grid.rings;
  const int first = std::max(0, static_cast<int>((at.theta_rad - outer_rad) / ring_rad) - 1);
  const int last = std::min(grid.rings - 1, static_cast<int>((at.theta_rad + outer_rad) / ring_rad) + 1);
  // Half the azimuths that a circle spans; all of them where it holds a pole.
  const bool pole = outer_rad >= std::min(at.theta_rad, kPi - at.theta_rad) - 1e-6;
  const double span = pole ? kPi : std::asin(std::min(1.0, std::sin(outer_rad) / std::sin(at.theta_rad)));
  const int half = std::min(grid.sectors / 2, static_cast<int>(span / (2 * kPi) * grid.sectors) + 1);
  const int middle = static_cast<int>(at.lambda_rad / (2 * kPi) * grid.sectors);
  const int count = std::min(2 * half + 1, grid.sectors);
  const int step = 1 + static_cast<int>(inner_rad / kThinned);
  const auto least = static_cast<float>(std::cos(outer_rad)), most = static_cast<float>(std::cos(inner_rad));
  for (int ring = first; ring <= last; ring += step)
    for (int i = 0; i < count; i += step) {
      const int sector = (middle - half + i + 2 * grid.sectors) % grid.sectors;
      const auto bin = static_cast<std::uint32_t>(ring * grid.sectors + sector);
      const float cosine = directions_[bin].dot(centre);
      if (cosine >= least && (inner_rad == 0 || cosine < most) && luminance_[bin] >= 0) bins.push_back(bin);
    }
}

// The lamp's bins: those above a luminance that hang together with the peak, and their neighbours. False where they reach
// beyond the largest lamp.
bool LampFinder::flood(std::uint32_t peak, float least, const Vec3f& centre) {
  const int rings = cells_.grid().rings, sectors = cells_.grid().sectors;
  const auto farthest = static_cast<float>(std::cos(kLastRadius));
  aperture_.assign(1, peak);
  std::fill(in_aperture_.begin(), in_aperture_.end(), false);
  in_aperture_[peak] = true;
  for (std::size_t next = 0; next < aperture_.size(); ++next) {
    const std::uint32_t bin = aperture_[next];
    if (directions_[bin].dot(centre) < farthest) return false;
    if (luminance_[bin] < least) continue;  // a neighbour, whose own do not count
    const int ring = static_cast<int>(bin) / sectors, sector = static_cast<int>(bin) % sectors;
    for (int r = std::max(ring - 1, 0); r <= std::min(ring + 1, rings - 1); ++r)
      for (int s = -1; s <= 1; ++s) {
        const auto other = static_cast<std::uint32_t>(r * sectors + (sector + s + sectors) % sectors);
        if (in_aperture_[other] || luminance_[other] < 0) continue;
        in_aperture_[other] = true;
        aperture_.push_back(other);
      }
  }
  return true;
}

// Luminance that a tenth of the map's bins do not reach: no lamp is six times brighter than its surroundings without being
// six times brighter than this.
double LampFinder::dark_level() {
  sorted_.clear();
  constexpr std::size_t kEvery = 37;  // a sample is enough; no multiple of usual numbers of sectors
  for (std::size_t bin = 0; bin < luminance_.size(); bin += kEvery)
    if (luminance_[bin] >= 0) sorted_.push_back(luminance_[bin]);
  if (sorted_.empty()) return 0;
  const auto tenth = sorted_.begin() + static_cast<std::ptrdiff_t>(sorted_.size() / 10);
  std::nth_element(sorted_.begin(), tenth, sorted_.end());
  return static_cast<double>(*tenth);
}

// Median luminance; of few bins whatever they are.
double LampFinder::surroundings(std::span<const std::uint32_t> bins) {
  sorted_.clear();
  for (const std::uint32_t bin : bins) sorted_.push_back(luminance_[bin]);
  if (sorted_.empty()) return 0;
  const auto middle = sorted_.begin() + static_cast<std::ptrdiff_t>(sorted_.size() / 2);
  std::nth_element(sorted_.begin(), middle, sorted_.end());
  return static_cast<double>(*middle);
}

void LampFinder::update_peaks(const Vec3f& centre, double radius_rad) {
  const PolarGrid& grid = cells_.grid();
  const double theta = spherical_from_direction(centre.cast<double>()).theta_rad;
  const auto sectors = static_cast<std::size_t>(grid.sectors);
  for (std::size_t ring = 0; ring < peak_.size(); ++ring) {
    const double middle = grid.theta_max_rad * (static_cast<double>(ring) + 0.5) / grid.rings;
    if (std::abs(middle - theta) > radius_rad + grid.theta_max_rad / grid.rings) continue;
    const auto begin = luminance_.begin() + static_cast<std::ptrdiff_t>(ring * sectors);
    peak_[ring] = static_cast<std::uint32_t>(
        std::max_element(begin, begin + static_cast<std::ptrdiff_t>(sectors)) - luminance_.begin());
  }
}

// Luminance of all bins; returns what the map sends, lux of luminance.
double LampFinder::load(const PolarMap& map) {
  const auto sectors = static_cast<std::size_t>(cells_.grid().sectors);
  double total = 0;
  for (std::size_t bin = 0; bin < luminance_.size(); ++bin) {
    const Rgb value = map.rgb(bin).max(0.0f);
    luminance_[bin] = (value - value).sum() == 0 ? luminance(value) : kTaken;
    if (luminance_[bin] > 0) total += static_cast<double>(luminance_[bin] * ring_solid_angle_[bin / sectors]);
  }
  return total;
}

// Widens a circle around a peak until the light beyond it no longer falls.
LampFinder::Circle LampFinder::circle_around(const Vec3f& centre, double peak) {
  Circle circle{kFirstRadius, 0, false};
  const auto luminance_beyond = [&](double radius_rad) {
    collect(centre, radius_rad, radius_rad * kGrowth + kDegree, ring_);
    return surroundings(ring_);
  };
  circle.around = luminance_beyond(circle.radius_rad);
  while (circle.radius_rad * kGrowth <= kLastRadius) {
    const double next = luminance_beyond(circle.radius_rad * kGrowth);
    circle.ends = next >= kStillFalling * circle.around && circle.around * kContrast < peak;
    if (circle.ends) break;
    circle.around = next;
    circle.radius_rad *= kGrowth;
  }
  return circle;
}

// Colour of the surroundings: the mean of the darker part of the ring.
Rgb LampFinder::background(const PolarMap& map, double around) const {
  Rgb sum = Rgb::Zero();
  int counted = 0;
  for (const std::uint32_t bin : ring_)
    if (static_cast<double>(luminance_[bin]) <= around) {
      sum += map.rgb(bin).max(0.0f);
      ++counted;
    }
  return sum / static_cast<float>(std::max(counted, 1));
}

// What stands above the background in the aperture; returns its lux of luminance.
double LampFinder::measure(const PolarMap& map, const Rgb& background, LampSighting& lamp) const {
  const auto sectors = static_cast<std::size_t>(cells_.grid().sectors);
  Vec3d moment = Vec3d::Zero();
  double weight = 0;
  std::array<double, harmonic_count(kRadianceDegree)> y;
  for (const std::uint32_t bin : aperture_) {
    const Rgb lux = (map.rgb(bin) - background).max(0.0f) * ring_solid_angle_[bin / sectors];
    const auto light = static_cast<double>(luminance(lux));
    if (!(light > 0)) continue;
    const Vec3d direction = directions_[bin].cast<double>();
    moment += light * direction;
    weight += light;
    lamp.illuminance += lux.cast<double>();
    harmonics(direction, kRadianceDegree, y.data());
    for (std::size_t h = 0; h < y.size(); ++h)
      lamp.harmonics.row(static_cast<Eigen::Index>(h)) += y[h] * lux.cast<double>().transpose();
    const std::uint32_t cell = cells_.cell_of(bin);
    auto share =
        std::find_if(lamp.shares.begin(), lamp.shares.end(), [&](const auto& s) { return s.cell == cell; });
    if (share == lamp.shares.end()) share = lamp.shares.insert(share, {cell, Rgb::Zero()});
    share->radiance += lux / cells_.solid_angle_sr()[cell];
  }
  if (!(weight > 0)) return 0;
  // |mean direction| = 1 − ⟨θ²⟩ / 2, and ⟨θ²⟩ = α² / 2 over an even disc.
  lamp.angular_radius_rad = 2 * std::sqrt(std::max(0.0, 1 - moment.norm() / weight));
  lamp.direction = moment.normalized();
  lamp.surroundings = background;
  double least = 1;
  for (const std::uint32_t bin : aperture_)
    least = std::min(least, lamp.direction.dot(directions_[bin].cast<double>()));
  const PolarGrid& grid = cells_.grid();  // and the half of a bin
  lamp.reach_rad = std::acos(std::max(least, -1.0)) + grid.theta_max_rad / grid.rings / 2;
  return weight;
}

// Nothing in the circle or the aperture is looked at again.
void LampFinder::take(const Vec3f& centre, double radius_rad) {
  for (const std::uint32_t bin : aperture_) luminance_[bin] = kTaken;
  collect(centre, 0, radius_rad, ring_);
  for (const std::uint32_t bin : ring_) luminance_[bin] = kTaken;
  double reach = radius_rad;
  for (const std::uint32_t bin : aperture_)
    reach = std::max(reach, std::acos(std::min(1.0, static_cast<double>(directions_[bin].dot(centre)))));
  update_peaks(centre, reach);
}

void LampFinder::find(const PolarMap& map, std::vector<LampSighting>& lamps) {
  lamps.clear();
  const double total = load(map);
  update_peaks(Vec3f::UnitY(), 2 * kPi);
  const double darkest = dark_level();
  for (std::size_t tries = 0; tries < 2 * kMostLamps && lamps.size() < kMostLamps; ++tries) {
    const std::uint32_t peak =
        *std::max_element(peak_.begin(), peak_.end(),
                          [&](std::uint32_t a, std::uint32_t b) { return luminance_[a] < luminance_[b]; });
    const auto brightest = static_cast<double>(luminance_[peak]);
    // Nothing left that could be a lamp: too little light, or no darker surroundings anywhere.
    if (!(brightest * 2 * kPi > total * kLeastShare) || brightest <= kContrast * darkest) break;
    const Vec3f centre = directions_[peak];
    aperture_.clear();
    const auto [radius, around, ends] = circle_around(centre, brightest);
    collect(centre, radius, radius * kGrowth + kDegree, ring_);
    const auto least = static_cast<float>(around + kEdge * (brightest - around));
    if (ends && flood(peak, least, centre) && !ring_.empty()) {
      LampSighting lamp;
      if (measure(map, background(map, around), lamp) > kLeastShare * total) lamps.push_back(std::move(lamp));
    }
    take(centre, radius);
  }
}

}  // namespace lightwell
