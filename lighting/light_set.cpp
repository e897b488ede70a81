// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/light_set.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lighting/result.h"
#include "lighting/second_moment.h"

namespace lightwell {
namespace {

// A point counts as a disc of 1°, so that two of them are as wide as they are apart.
double solid_angle_sr(const DirectionalLight& light) {
  constexpr double kPoint = 0.0175;
  const double radius = std::max(static_cast<double>(light.angular_radius_rad), kPoint);
  return kPi * radius * radius;
}

// changed: of the folded lights, those into which others went
void fold_sizes(const LightSet& set, const std::vector<bool>& changed, LightSet& folded) {
  const std::size_t count = folded.lights.size();
  std::vector<SecondMoment> sizes(count);
  std::vector<std::size_t> shown_by(set.lights.size());
  for (std::size_t i = 0; i < set.lights.size(); ++i) {
    const DirectionalLight& light = set.lights[i];
    shown_by[i] = i < count ? i : shown_by[static_cast<std::size_t>(light.parent)];
    const auto distance =
        static_cast<double>((light.direction - folded.lights[shown_by[i]].direction).norm());
    sizes[shown_by[i]].add(luminance(Rgbd(light.illuminance.cast<double>())), solid_angle_sr(light),
                           distance);
  }
  for (std::size_t i = 0; i < count; ++i)
    if (changed[i]) folded.lights[i].angular_radius_rad = sizes[i].disc_radius_rad();
}

// Children into parents from last to first; a light's direction is the luminance-weighted mean of what it
// stands for.
LightSet fold(const LightSet& set, std::size_t count) {
  std::vector<Rgbd> illuminance;
  std::vector<Vec3d> moment;
  for (const DirectionalLight& light : set.lights) {
    illuminance.push_back(light.illuminance.cast<double>());
    moment.push_back(light.direction.cast<double>() * luminance(illuminance.back()));
  }
  LightSet folded = set;
  std::vector<bool> changed(set.lights.size(), false);
  for (std::size_t i = set.lights.size(); i-- > count;) {
    const auto parent = static_cast<std::size_t>(set.lights[i].parent);
    verify_bug(parent < i, "a light's parent is not an earlier light");
    illuminance[parent] += illuminance[i];
    moment[parent] += moment[i];
    changed[parent] = true;
  }
  folded.lights.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (!changed[i]) continue;
    folded.lights[i].illuminance = illuminance[i].cast<float>();
    // Opposite or dark lights have no mean direction: the parent keeps its own.
    const double length = moment[i].norm();
    if (length > 1e-6 * luminance(illuminance[i]))
      folded.lights[i].direction = (moment[i] / length).cast<float>();
  }
  fold_sizes(set, changed, folded);
  return folded;
}

LightSet rescale_prefix(const LightSet& set, std::size_t count) {
  LightSet prefix = set;
  prefix.lights.resize(count);
  Rgbd all = Rgbd::Zero();
  Rgbd kept = Rgbd::Zero();
  for (std::size_t i = 0; i < set.lights.size(); ++i) {
    all += set.lights[i].illuminance.cast<double>();
    if (i < count) kept += set.lights[i].illuminance.cast<double>();
  }
  const double kept_luminance = luminance(kept);
  for (DirectionalLight& light : prefix.lights) {
    const Rgbd own = light.illuminance.cast<double>();
    const double share =
        kept_luminance > 0 ? luminance(own) / kept_luminance : 1.0 / static_cast<double>(count);
    for (int c = 0; c < 3; ++c) {
      const double scaled = kept[c] > 0 ? own[c] * (all[c] / kept[c]) : all[c] * share;
      light.illuminance[c] = static_cast<float>(scaled);
    }
  }
  return prefix;
}

}  // namespace

LightSet take_lights(const LightSet& set, std::size_t count) {
  if (count >= set.lights.size()) return set;
  if (count == 0) {
    LightSet none = set;
    none.lights.clear();
    return none;
  }
  return set.has_parents ? fold(set, count) : rescale_prefix(set, count);
}

}  // namespace lightwell
