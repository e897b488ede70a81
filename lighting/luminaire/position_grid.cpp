// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/luminaire/position_grid.h"

#include <algorithm>
#include <cmath>

#include "lighting/result.h"

namespace lightwell {
namespace {

// Of places on a lattice of spacing 1, from −½ to ½: the direction of their mean on a circle that is one spacing around.
double mean_phase(std::span<const Vec2d> places, int axis, double spacing) {
  double sine = 0, cosine = 0;
  for (const Vec2d& place : places) {
    const double turn = 2 * kPi * (place[axis] - places[0][axis]) / spacing;
    sine += std::sin(turn);
    cosine += std::cos(turn);
  }
  return std::atan2(sine, cosine) / (2 * kPi);
}

// What the neighbours along an axis say of a position; false: too few of them.
bool add_estimate(const LampImages& images, const std::vector<bool>& measured, int u, int v, int axis,
                  std::vector<Rgb>& sum) {
  const LampPlanes& planes = images.planes;
  const auto neighbour = [&](int step) -> const Rgb* {
    const int iu = u + (axis == 0 ? step : 0), iv = v + (axis == 1 ? step : 0);
    if (iu < 0 || iv < 0 || iu >= planes.positions[0] || iv >= planes.positions[1]) return nullptr;
    return measured[planes.image(iu, iv)] ? images.image(iu, iv) : nullptr;
  };
  const std::array<const Rgb*, 4> from = {neighbour(-2), neighbour(-1), neighbour(1), neighbour(2)};
  if (from[1] == nullptr || from[2] == nullptr) return false;
  const bool four = from[0] != nullptr && from[3] != nullptr;
  const float near = four ? 4.0f / 6 : 0.5f, far = four ? -1.0f / 6 : 0.0f;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    sum[i] += near * (from[1][i] + from[2][i]);
    if (four) sum[i] += far * (from[0][i] + from[3][i]);
  }
  return true;
}

// taps (−v/2, 1 + v, −v/2) along a line of pixels; beyond its ends the last one.
void restore_line(Rgb* first, int count, std::ptrdiff_t step, float variance) {
  Rgb before = *first, here = *first;
  for (int i = 0; i < count; ++i) {
    Rgb& target = first[i * step];
    const Rgb after = i + 1 < count ? first[(i + 1) * step] : here;
    target = here + variance / 2 * (2 * here - before - after);
    before = here;
    here = after;
  }
}

}  // namespace

PositionGrid position_grid(std::span<const Vec2d> places_m, double spacing_m) {
  verify_bug(!places_m.empty() && spacing_m > 0, "no positions");
  PositionGrid grid;
  const Vec2d origin =
      places_m[0] + spacing_m * Vec2d(mean_phase(places_m, 0, spacing_m), mean_phase(places_m, 1, spacing_m));
  std::array<int, 2> least = {1 << 30, 1 << 30}, most = {-(1 << 30), -(1 << 30)};
  for (const Vec2d& place : places_m) {
    const Vec2d steps = (place - origin) / spacing_m;
    const std::array<int, 2> at = {static_cast<int>(std::lround(steps.x())),
                                   static_cast<int>(std::lround(steps.y()))};
    for (std::size_t axis = 0; axis < 2; ++axis) {
      least[axis] = std::min(least[axis], at[axis]);
      most[axis] = std::max(most[axis], at[axis]);
    }
    grid.at.push_back(at);
    grid.deviation_m.push_back((steps - Vec2d(at[0], at[1])).norm() * spacing_m);
  }
  for (std::size_t axis = 0; axis < 2; ++axis) grid.positions[axis] = most[axis] - least[axis] + 1;
  for (auto& at : grid.at) at = {at[0] - least[0], at[1] - least[1]};
  grid.first_m = origin + spacing_m * Vec2d(least[0], least[1]);
  return grid;
}

void complete_positions(LampImages& images, std::vector<bool>& measured) {
  const LampPlanes& planes = images.planes;
  const std::vector<bool> given = measured;
  for (int v = 0; v < planes.positions[1]; ++v)
    for (int u = 0; u < planes.positions[0]; ++u) {
      if (given[planes.image(u, v)]) continue;
      std::vector<Rgb> sum(planes.image_size(), Rgb::Zero());
      const bool along = add_estimate(images, given, u, v, 0, sum);
      const bool across = add_estimate(images, given, u, v, 1, sum);
      if (!along && !across) continue;
      const float share = along && across ? 0.5f : 1.0f;
      std::transform(sum.begin(), sum.end(), images.image(u, v), [&](const Rgb& s) { return share * s; });
      measured[planes.image(u, v)] = true;
    }
}

void restore_centres(LampImages& images, const Vec2d& variance) {
  const LampPlanes& planes = images.planes;
  const auto [width, height] = planes.pixels;
  for (int v = 0; v < planes.positions[1]; ++v)
    for (int u = 0; u < planes.positions[0]; ++u) {
      Rgb* image = images.image(u, v);
      for (int t = 0; t < height; ++t)
        restore_line(image + static_cast<std::ptrdiff_t>(t) * width, width, 1,
                     static_cast<float>(variance.x()));
      for (int s = 0; s < width; ++s)
        restore_line(image + s, height, width, static_cast<float>(variance.y()));
    }
}

}  // namespace lightwell
