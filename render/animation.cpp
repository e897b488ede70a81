// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/animation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace lightwell::render {
namespace {

void normalize(std::span<float> quaternion) {
  double squared = 0;
  for (const float x : quaternion) squared += static_cast<double>(x) * static_cast<double>(x);
  if (!(squared > 0)) {
    // Two opposite turns met half way: any turn is as right as another.
    std::fill(quaternion.begin(), quaternion.end(), 0.0f);
    quaternion.back() = 1;
    return;
  }
  for (float& x : quaternion) x = static_cast<float>(x / std::sqrt(squared));
}

void slerp(std::span<const float> a, std::span<const float> b, double t, std::span<float> value) {
  double cosine = 0;
  for (std::size_t i = 0; i < 4; ++i) cosine += static_cast<double>(a[i]) * static_cast<double>(b[i]);
  const double sign = cosine < 0 ? -1 : 1;  // the shorter way round
  const double angle = std::acos(std::min(std::abs(cosine), 1.0));
  const double sine = std::sin(angle);
  // Below this angle the arc is its chord to the last bit.
  const bool straight = sine < 1e-6;
  const double from = straight ? 1 - t : std::sin((1 - t) * angle) / sine;
  const double to = sign * (straight ? t : std::sin(t * angle) / sine);
  for (std::size_t i = 0; i < 4; ++i) value[i] = static_cast<float>(from * a[i] + to * b[i]);
}

}  // namespace

void sample(const Track& track, double time_s, std::span<float> value) {
  const bool cubic = track.interpolation == Interpolation::cubic_spline;
  const std::size_t stride = track.width * (cubic ? 3 : 1);
  const auto part = [&](std::size_t key, std::size_t which) {
    return std::span(track.values).subspan(key * stride + which * track.width, track.width);
  };
  const auto key_value = [&](std::size_t key) { return part(key, cubic ? 1 : 0); };
  const auto after = std::upper_bound(track.times_s.begin(), track.times_s.end(), time_s);
  const auto next = static_cast<std::size_t>(after - track.times_s.begin());
  const bool rotation = track.property == Track::Property::rotation;
  if (next == 0 || next == track.times_s.size() || track.interpolation == Interpolation::step) {
    const auto held = key_value(next == 0 ? 0 : next - 1);
    std::copy(held.begin(), held.end(), value.begin());
    if (rotation) normalize(value);
    return;
  }
  const std::size_t key = next - 1;
  const double from_s = static_cast<double>(track.times_s[key]);
  const double span_s = static_cast<double>(track.times_s[next]) - from_s;
  const double t = (time_s - from_s) / span_s;
  const auto a = key_value(key);
  const auto b = key_value(next);
  if (cubic) {
    const auto out = part(key, 2);
    const auto in = part(next, 0);
    const double t2 = t * t;
    const double t3 = t2 * t;
    for (std::size_t i = 0; i < track.width; ++i)
      value[i] = static_cast<float>((2 * t3 - 3 * t2 + 1) * a[i] + span_s * (t3 - 2 * t2 + t) * out[i] +
                                    (3 * t2 - 2 * t3) * b[i] + span_s * (t3 - t2) * in[i]);
  } else if (rotation) {
    slerp(a, b, t, value);
  } else {
    for (std::size_t i = 0; i < track.width; ++i) value[i] = static_cast<float>((1 - t) * a[i] + t * b[i]);
  }
  if (rotation) normalize(value);
}

double looped(double time_s, double length_s) {
  if (!(length_s > 0)) return 0;
  const double rest = std::fmod(time_s, length_s);
  return rest < 0 ? rest + length_s : rest;
}

}  // namespace lightwell::render
