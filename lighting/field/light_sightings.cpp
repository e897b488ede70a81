// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/light_sightings.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace lightwell {
namespace {

constexpr double kDegree = kPi / 180;
constexpr double kFirstRadius = 3 * kDegree, kLastRadius = 15 * kDegree, kGrowth = 1.3;
constexpr double kRing = 2;           // the surroundings: up to so many radii
constexpr double kContrast = 6;       // of the circle over its surroundings, light a steradian
constexpr double kLeastShare = 0.02;  // of the set's light

// Light of the lights within an angle, of those that are left; with their indices.
struct Circle {
  double light = 0;
  std::vector<std::size_t> lights;
};

class Search {
 public:
  explicit Search(const LightSet& set) : set_(set), taken_(set.lights.size(), false) {
    for (const DirectionalLight& light : set.lights) {
      light_.push_back(std::max(0.0, static_cast<double>(luminance(light.illuminance))));
      total_ += light_.back();
    }
  }

  [[nodiscard]] std::optional<std::size_t> brightest() const {
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < light_.size(); ++i)
      if (!taken_[i] && light_[i] > 0 && (!best || light_[i] > light_[*best])) best = i;
    return best;
  }

  [[nodiscard]] Circle within(const Vec3f& centre, double radius_rad) const {
    Circle circle;
    const auto least = static_cast<float>(std::cos(radius_rad));
    for (std::size_t i = 0; i < light_.size(); ++i)
      if (!taken_[i] && set_.lights[i].direction.dot(centre) >= least) {
        circle.light += light_[i];
        circle.lights.push_back(i);
      }
    return circle;
  }

  // The smallest circle whose surroundings are dark beside it.
  [[nodiscard]] std::optional<Circle> lamp_about(const Vec3f& centre) const {
    for (double radius = kFirstRadius; radius <= kLastRadius; radius *= kGrowth) {
      Circle circle = within(centre, radius);
      if (circle.light <= kLeastShare * total_) return std::nullopt;
      const double around = within(centre, kRing * radius).light - circle.light;
      const double inner_sr = 1 - std::cos(radius), ring_sr = 1 - std::cos(kRing * radius) - inner_sr;
      if (circle.light / inner_sr > kContrast * around / ring_sr) return circle;
    }
    return std::nullopt;
  }

  void take(const std::vector<std::size_t>& lights) {
    for (const std::size_t i : lights) taken_[i] = true;
  }

  [[nodiscard]] LampSighting measure(const Circle& circle) const {
    LampSighting lamp;
    Vec3d moment = Vec3d::Zero();
    double own = 0;  // ⟨θ²⟩ of the lights' own discs
    for (const std::size_t i : circle.lights) {
      const DirectionalLight& light = set_.lights[i];
      lamp.illuminance += light.illuminance.cast<double>();
      moment += light_[i] * light.direction.cast<double>();
      own += light_[i] * std::pow(static_cast<double>(light.angular_radius_rad), 2) / 2;
    }
    lamp.direction = moment.normalized();
    // As of maps (lamp_sightings.cpp): ⟨θ²⟩ = α² / 2 of an even disc.
    const double spread = 2 * std::max(0.0, 1 - moment.norm() / circle.light);
    lamp.angular_radius_rad = std::sqrt(2 * (spread + own / circle.light));
    return lamp;
  }

 private:
  const LightSet& set_;
  std::vector<bool> taken_;
  std::vector<double> light_;  // luminance, lux
  double total_ = 0;
};

}  // namespace

std::vector<LightSighting> light_sightings(const LightSet& set) {
  std::vector<LightSighting> found;
  Search search(set);
  for (std::size_t tries = 0; tries < 2 * LampFinder::kMostLamps && found.size() < LampFinder::kMostLamps;
       ++tries) {
    const auto brightest = search.brightest();
    if (!brightest) break;
    if (auto circle = search.lamp_about(set.lights[*brightest].direction)) {
      search.take(circle->lights);
      found.push_back({search.measure(*circle), std::move(circle->lights)});
    } else {
      search.take({*brightest});
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const LightSighting& a, const LightSighting& b) {
    return luminance(a.lamp.illuminance) > luminance(b.lamp.illuminance);
  });
  return found;
}

}  // namespace lightwell
