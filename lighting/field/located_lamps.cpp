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

  // Whose rays cross, in one way only.
  void take_crossing() {
    for (std::size_t n = 0; n < probes_.size(); ++n) ambiguous_.emplace_back(probes_[n].lamps.size(), false);
    for (CrossingLamp& crossing : crossing_lamps(probes_, sigma_)) {
      if (crossing.ambiguous) {
        for (std::size_t n = 0; n < probes_.size(); ++n)
          if (const int i = crossing.sightings[n]; i >= 0) ambiguous_[n][static_cast<std::size_t>(i)] = true;
        continue;
      }
      LocatedLamp lamp;
      lamp.sightings = std::move(crossing.sightings);
      locate(lamp);
      claim(std::move(lamp));
    }
    // Shares of a sighting that two lamps claim rest on intensities, which rest on the other probes' shares.
    for (LocatedLamp& lamp : lamps_) lamp.intensity = Rgbd::Ones();
    for (int round = 0; round < 4; ++round)
      for (LocatedLamp& lamp : lamps_) measure_near(lamp);
  }

  // Who see it where the others do, and those that are left alone.
  void take_parallel() {
    for (std::size_t n = 0; n < probes_.size(); ++n)
      for (std::size_t i = 0; i < probes_[n].lamps.size(); ++i) {
        if (claimed_[n][i]) continue;
        LocatedLamp lamp;
        lamp.sightings.assign(probes_.size(), -1);
        lamp.sightings[n] = static_cast<int>(i);
        for (std::size_t m = n + 1; m < probes_.size() && !ambiguous_[n][i]; ++m)
          lamp.sightings[m] = alike(m, probes_[n].lamps[i]);
        if (!locate(lamp) || lamp.location.chi_square > kChiSquare * lamp.location.degrees_of_freedom) {
          std::fill(lamp.sightings.begin(), lamp.sightings.end(), -1);  // no one light: this one alone
          lamp.sightings[n] = static_cast<int>(i);
          locate(lamp);
        }
        lamp.ambiguous = ambiguous_[n][i];
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
      if (claimed_[probe][i] || ambiguous_[probe][i] || ratio > kSamePower || ratio * kSamePower < 1)
        continue;
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

  // Of a sighting each of its lamps has what its mean intensity foretells.
  void measure_near(LocatedLamp& lamp) const {
    const Vec3d& place = lamp.location.position;
    lamp.intensity_toward.assign(probes_.size(), Rgbd::Zero());
    lamp.known.assign(probes_.size(), false);
    Rgbd sum = Rgbd::Zero();
    double seen = 0, radius_m = 0;
    for (std::size_t n = 0; n < probes_.size(); ++n) {
      const int i = lamp.sightings[n];
      lamp.known[n] = i >= 0 || looks_at(probes_[n], place);
      if (i < 0) continue;
      const double square = (place - probes_[n].position).squaredNorm();
      double all = 0;
      for (const LocatedLamp& other : lamps_)
        if (other.sightings[n] == i)
          all += luminance(other.intensity) / (other.location.position - probes_[n].position).squaredNorm();
      const double share = all > 0 ? luminance(lamp.intensity) / square / all : 1;
      lamp.intensity_toward[n] = sighting(n, i).illuminance * (share * square);
      sum += lamp.intensity_toward[n];
      radius_m += std::sqrt(square) * std::sin(std::min(sighting(n, i).angular_radius_rad, kPi / 2));
      ++seen;
    }
    lamp.intensity = sum / seen;
    lamp.radius_m = radius_m / seen;
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
  std::vector<std::vector<bool>> claimed_, ambiguous_;  // [probes][sightings]
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
