// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/located_lamps.h"

#include <algorithm>
#include <cmath>

namespace lightwell {
namespace {

constexpr double kDegree = kPi / 180;
constexpr double kSameDirection = 4 * kDegree;  // beyond it a lamp's rays cross well enough to be tracked
constexpr double kSamePower = 2;                // between two probes that see one far light
constexpr double kChiSquare = 16;               // of a degree of freedom, of rays that are one light's

class Association {
 public:
  Association(std::span<const ProbeSightings> probes, double sigma_rad) : probes_(probes), sigma_(sigma_rad) {
    for (const ProbeSightings& probe : probes) claimed_.emplace_back(probe.lamps.size(), false);
  }

  // Whose rays cross.
  void take_crossing() {
    LampTracks tracks;
    tracks.update(probes_, 0);
    for (const LampTrack& track : tracks.lamps()) {
      LocatedLamp lamp;
      for (const LampTrack::Link& link : track.links) lamp.sightings.push_back(link.sighting);
      if (!locate(lamp) || !lamp.location.is_near()) continue;
      lamp.intensity = track.intensity;
      lamp.radius_m = track.radius_m;
      for (const LampTrack::Link& link : track.links) {
        lamp.intensity_toward.push_back(link.intensity);
        lamp.known.push_back(link.known);
      }
      claim(std::move(lamp));
    }
  }

  // Who see it where the others do, and those that are left alone.
  void take_parallel() {
    for (std::size_t n = 0; n < probes_.size(); ++n)
      for (std::size_t i = 0; i < probes_[n].lamps.size(); ++i) {
        if (claimed_[n][i]) continue;
        LocatedLamp lamp;
        lamp.sightings.assign(probes_.size(), -1);
        lamp.sightings[n] = static_cast<int>(i);
        for (std::size_t m = n + 1; m < probes_.size(); ++m)
          lamp.sightings[m] = alike(m, probes_[n].lamps[i]);
        if (!locate(lamp) || lamp.location.chi_square > kChiSquare * lamp.location.degrees_of_freedom) {
          std::fill(lamp.sightings.begin(), lamp.sightings.end(), -1);  // no one light: this one alone
          lamp.sightings[n] = static_cast<int>(i);
          locate(lamp);
        }
        measure(lamp);
        claim(std::move(lamp));
      }
  }

  std::vector<LocatedLamp> take_lamps() {
    std::stable_sort(lamps_.begin(), lamps_.end(), [](const LocatedLamp& a, const LocatedLamp& b) {
      if (a.location.is_near() != b.location.is_near()) return a.location.is_near();
      return a.location.is_near() ? luminance(a.intensity) > luminance(b.intensity)
                                  : luminance(a.illuminance) > luminance(b.illuminance);
    });
    return std::move(lamps_);
  }

 private:
  [[nodiscard]] const LampSighting& sighting(std::size_t probe, int i) const {
    return probes_[probe].lamps[static_cast<std::size_t>(i)];
  }

  // The sighting of a probe that may be the same far light; −1: none.
  [[nodiscard]] int alike(std::size_t probe, const LampSighting& lamp) const {
    int best = -1;
    double most = std::cos(kSameDirection);
    for (std::size_t i = 0; i < probes_[probe].lamps.size(); ++i) {
      const LampSighting& other = probes_[probe].lamps[i];
      const double ratio = luminance(other.illuminance) / std::max(luminance(lamp.illuminance), 1e-30);
      if (claimed_[probe][i] || ratio > kSamePower || ratio * kSamePower < 1) continue;
      if (const double cosine = other.direction.dot(lamp.direction); cosine > most) {
        most = cosine;
        best = static_cast<int>(i);
      }
    }
    return best;
  }

  bool locate(LocatedLamp& lamp) const {
    std::vector<SightRay> rays;
    for (std::size_t n = 0; n < probes_.size(); ++n)
      if (lamp.sightings[n] >= 0) {
        if (rays.empty()) lamp.from = static_cast<int>(n);
        rays.push_back({probes_[n].position, sighting(n, lamp.sightings[n]).direction});
      }
    const auto location = locate_lamp(rays, sigma_);
    if (location) lamp.location = *location;
    return location.has_value();
  }

  // What probes that see it under one direction say of its light.
  void measure(LocatedLamp& lamp) const {
    double seen = 0;
    for (std::size_t n = 0; n < probes_.size(); ++n) {
      lamp.intensity_toward.push_back(Rgbd::Zero());
      lamp.known.push_back(lamp.sightings[n] >= 0);
      if (lamp.sightings[n] < 0) continue;
      const LampSighting& one = sighting(n, lamp.sightings[n]);
      ++seen;
      lamp.illuminance += one.illuminance;
      lamp.angular_radius_rad += one.angular_radius_rad;
      if (!lamp.location.is_near()) continue;
      const double distance = (lamp.location.position - probes_[n].position).norm();
      lamp.intensity_toward.back() = one.illuminance * (distance * distance);
      lamp.intensity += lamp.intensity_toward.back();
      lamp.radius_m += distance * std::sin(one.angular_radius_rad);
    }
    lamp.illuminance /= seen;
    lamp.angular_radius_rad /= seen;
    lamp.intensity /= seen;
    lamp.radius_m /= seen;
  }

  void claim(LocatedLamp lamp) {
    for (std::size_t n = 0; n < probes_.size(); ++n)
      if (lamp.sightings[n] >= 0) claimed_[n][static_cast<std::size_t>(lamp.sightings[n])] = true;
    lamps_.push_back(std::move(lamp));
  }

  std::span<const ProbeSightings> probes_;
  double sigma_;
  std::vector<std::vector<bool>> claimed_;  // [probes][sightings]
  std::vector<LocatedLamp> lamps_;
};

}  // namespace

std::vector<LocatedLamp> locate_lamps(std::span<const ProbeSightings> probes, double sigma_rad) {
  Association association(probes, sigma_rad);
  association.take_crossing();
  association.take_parallel();
  return association.take_lamps();
}

}  // namespace lightwell
