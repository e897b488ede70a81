// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/lamp_association.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

namespace lightwell {
namespace {

constexpr double kGate = 4;                      // standard deviations between a place and its rays
constexpr double kChiSquare = 9;                 // of a degree of freedom, of rays that are one lamp's
constexpr double kTwoAgree = 2, kMoreAgree = 4;  // factor between intensities that probes see
constexpr double kLamp = 1.5;  // what a lamp must explain, in sightings: the price of one more
constexpr std::size_t kMostPlaces = 128;
constexpr int kMostSteps = 20000;  // of the search

struct Place {
  CrossingLamp lamp;
  int support = 0;
};

class Places {
 public:
  Places(std::span<const ProbeSightings> probes, double sigma_rad) : probes_(probes), sigma_(sigma_rad) {
    for (std::size_t p = 0; p < probes.size(); ++p)
      for (std::size_t q = p + 1; q < probes.size(); ++q)
        for (std::size_t i = 0; i < probes[p].lamps.size(); ++i)
          for (std::size_t j = 0; j < probes[q].lamps.size(); ++j) try_pair(p, i, q, j);
    std::stable_sort(found_.begin(), found_.end(), [](const Place& a, const Place& b) {
      if (a.support != b.support) return a.support > b.support;
      return a.lamp.location.chi_square < b.lamp.location.chi_square;
    });
    if (found_.size() > kMostPlaces) found_.resize(kMostPlaces);
  }
  std::vector<Place> take() { return std::move(found_); }

 private:
  [[nodiscard]] std::optional<LampLocation> locate(const std::vector<int>& sightings) const {
    std::vector<SightRay> rays;
    for (std::size_t n = 0; n < probes_.size(); ++n)
      if (sightings[n] >= 0)
        rays.push_back(
            {probes_[n].position, probes_[n].lamps[static_cast<std::size_t>(sightings[n])].direction});
    const auto found = locate_lamp(rays, sigma_);
    if (!found || !found->is_near() || found->chi_square > kChiSquare * found->degrees_of_freedom)
      return std::nullopt;
    for (const SightRay& ray : rays)
      if ((found->position - ray.origin).norm() <= kLeastLampDistance_m) return std::nullopt;
    return found;
  }

  [[nodiscard]] double intensity(std::size_t probe, int sighting, const Vec3d& place) const {
    return luminance(probes_[probe].lamps[static_cast<std::size_t>(sighting)].illuminance) *
           (place - probes_[probe].position).squaredNorm();
  }

  // The sighting of a probe that a place explains; −1: none.
  [[nodiscard]] int explained(std::size_t probe, const LampLocation& at) const {
    const Vec3d toward = at.position - probes_[probe].position;
    const double square = std::max(toward.squaredNorm(), 1e-12);
    const Vec3d unit = toward / std::sqrt(square);
    const double across = (at.covariance.trace() - unit.dot(at.covariance * unit)) / 2;
    double least = kGate * std::sqrt(sigma_ * sigma_ + std::max(across, 0.0) / square);
    int best = -1;
    for (std::size_t i = 0; i < probes_[probe].lamps.size(); ++i) {
      const Vec3d& direction = probes_[probe].lamps[i].direction;
      const double angle = std::atan2(direction.cross(unit).norm(), direction.dot(unit));
      if (angle < least) {
        least = angle;
        best = static_cast<int>(i);
      }
    }
    return best;
  }

  void try_pair(std::size_t p, std::size_t i, std::size_t q, std::size_t j) {
    std::vector<int> sightings(probes_.size(), -1);
    sightings[p] = static_cast<int>(i);
    sightings[q] = static_cast<int>(j);
    const auto pair = locate(sightings);
    if (!pair) return;
    for (std::size_t n = 0; n < probes_.size(); ++n)
      if (sightings[n] < 0 && probes_[n].present) sightings[n] = explained(n, *pair);
    if (!tried_.insert(sightings).second) return;
    const auto all = locate(sightings);
    if (!all) return;
    Place place{{sightings, *all, false}, 0};
    int denied = 0;
    double least = std::numeric_limits<double>::max(), most = 0;
    for (std::size_t n = 0; n < probes_.size(); ++n) {
      if (sightings[n] < 0) {
        denied += looks_at(probes_[n], all->position) && explained(n, *all) < 0 ? 1 : 0;
        continue;
      }
      ++place.support;
      least = std::min(least, intensity(n, sightings[n], all->position));
      most = std::max(most, intensity(n, sightings[n], all->position));
    }
    if (most > (place.support > 2 ? kMoreAgree : kTwoAgree) * least) return;
    if (denied > 0 && place.support - denied < 2) return;
    found_.push_back(std::move(place));
  }

  std::span<const ProbeSightings> probes_;
  double sigma_;
  std::vector<Place> found_;
  std::set<std::vector<int>> tried_;
};

// The places that explain the most for their number: exhaustive, with what is left to explain as the bound.
class Choice {
 public:
  Choice(std::span<const ProbeSightings> probes, const std::vector<Place>& places) : places_(places) {
    for (const ProbeSightings& probe : probes) used_.emplace_back(probe.lamps.size(), 0);
  }

  struct Best {
    double value = 0;
    std::vector<std::size_t> places;
  };
  // Without one of them; none is left out where that is their number.
  Best find(std::size_t without) {
    best_ = {};
    chosen_.clear();
    steps_ = 0;
    search(0, 0, without);
    return best_;
  }

 private:
  [[nodiscard]] int own(const Place& place) const {
    int own = 0;
    for (std::size_t n = 0; n < used_.size(); ++n)
      if (const int i = place.lamp.sightings[n]; i >= 0) own += used_[n][static_cast<std::size_t>(i)] == 0;
    return own;
  }
  void use(const Place& place, int change) {
    for (std::size_t n = 0; n < used_.size(); ++n)
      if (const int i = place.lamp.sightings[n]; i >= 0) used_[n][static_cast<std::size_t>(i)] += change;
  }
  // No choice of the places from here on adds more: what they could explain, by as few as may be.
  double most_left(std::size_t next, std::size_t without) {
    std::set<std::pair<std::size_t, int>> left;
    int largest = 0;
    for (std::size_t k = next; k < places_.size(); ++k) {
      if (k == without || own(places_[k]) < 2) continue;
      largest = std::max(largest, own(places_[k]));
      for (std::size_t n = 0; n < used_.size(); ++n)
        if (const int i = places_[k].lamp.sightings[n]; i >= 0 && used_[n][static_cast<std::size_t>(i)] == 0)
          left.emplace(n, i);
    }
    if (largest == 0) return 0;
    return static_cast<double>(left.size()) - kLamp * std::ceil(static_cast<double>(left.size()) / largest);
  }
  void search(std::size_t next, double value, std::size_t without) {
    if (value > best_.value + 1e-9) best_ = {value, chosen_};
    if (next == places_.size() || ++steps_ > kMostSteps) return;
    if (value + most_left(next, without) <= best_.value + 1e-9) return;
    const int own_now = own(places_[next]);
    if (own_now >= 2 && next != without) {
      use(places_[next], 1);
      chosen_.push_back(next);
      search(next + 1, value + own_now - kLamp, without);
      chosen_.pop_back();
      use(places_[next], -1);
    }
    search(next + 1, value, without);
  }

  const std::vector<Place>& places_;
  std::vector<std::vector<int>> used_;  // [probes][sightings], by how many chosen places
  std::vector<std::size_t> chosen_;
  Best best_;
  int steps_ = 0;
};

}  // namespace

std::vector<CrossingLamp> crossing_lamps(std::span<const ProbeSightings> probes, double sigma_rad) {
  const std::vector<Place> places = Places(probes, sigma_rad).take();
  Choice choice(probes, places);
  const Choice::Best best = choice.find(places.size());
  std::vector<CrossingLamp> lamps;
  for (const std::size_t k : best.places) {
    lamps.push_back(places[k].lamp);
    lamps.back().ambiguous = choice.find(k).value > best.value - 0.25;
  }
  return lamps;
}

}  // namespace lightwell
