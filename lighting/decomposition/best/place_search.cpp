// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/decomposition/best/place_search.h"

#include <algorithm>

namespace lightwell {
namespace {

constexpr int kAllAtomsUpTo = 128;  // lights

// A place nearer to a light than this is that light's.
constexpr float kLeastDistance = 0.0035f;  // 0.2°

}  // namespace

int PlaceSearch::most_places(int lights) {
  return lights <= kAllAtomsUpTo ? std::clamp(lights, 16, 64) : 32;
}

PlaceSearch::PlaceSearch(int lights, int atoms)
    : nearest_(static_cast<std::size_t>(atoms), 0),
      distance_(static_cast<std::size_t>(atoms), 0),
      quadrant_score_(4 * static_cast<std::size_t>(lights), 0),
      quadrant_atom_(4 * static_cast<std::size_t>(lights), -1),
      place_points_(most_places(lights)) {
  order_.reserve(4 * static_cast<std::size_t>(lights));
  places_.reserve(static_cast<std::size_t>(most_places(lights)));
}

int PlaceSearch::middle(const Atoms& atoms) {
  return atoms.padded() / 2 / placement_kernel::kLanes * placement_kernel::kLanes;
}

void PlaceSearch::look(const Atoms& atoms, const PlacedLights& lights, bool all) noexcept {
  const bool by_halves = lights.count() > kAllAtomsUpTo && !all;
  begin_ = by_halves && second_half_ ? middle(atoms) : 0;
  end_ = by_halves && !second_half_ ? middle(atoms) : atoms.padded();
  second_half_ = !second_half_;
  auto points = atoms.points();
  points.x += begin_, points.y += begin_, points.z += begin_, points.s += begin_;
  points.count = end_ - begin_;
  placement_kernel::kernels().nearest(points, lights.points(), nearest_.data() + begin_,
                                      distance_.data() + begin_);
  end_ = std::min(end_, atoms.count);
}

void PlaceSearch::find(const Atoms& atoms, const PlacedLights& lights) noexcept {
  std::fill(quadrant_score_.begin(), quadrant_score_.end(), 0.0f);
  std::fill(quadrant_atom_.begin(), quadrant_atom_.end(), -1);
  const auto points = lights.points();
  for (auto k = static_cast<std::size_t>(begin_); k < static_cast<std::size_t>(end_); ++k) {
    if (distance_[k] < kLeastDistance) continue;
    const auto i = static_cast<std::size_t>(nearest_[k]);
    const float dx = atoms.x[k] - points.x[i], dz = atoms.z[k] - points.z[i];
    const float along = points.z[i] * dx - points.x[i] * dz;
    const float up = atoms.y[k] - points.y[i];
    const std::size_t q = 4 * i + (along > 0 ? 1 : 0) + (up > 0 ? 2 : 0);
    const float score = atoms.luminance[k] * distance_[k];
    if (score > quadrant_score_[q]) {
      quadrant_score_[q] = score;
      quadrant_atom_[q] = static_cast<int>(k);
    }
  }
  order_.clear();
  for (std::size_t q = 0; q < quadrant_atom_.size(); ++q)
    if (quadrant_atom_[q] >= 0) order_.push_back(static_cast<int>(q));
  const auto most = static_cast<std::size_t>(most_places(lights.count()));
  const auto worse = [&](int a, int b) {
    const float p = quadrant_score_[static_cast<std::size_t>(a)],
                q = quadrant_score_[static_cast<std::size_t>(b)];
    return p > q || (p == q && a < b);
  };
  if (order_.size() > most) {
    std::nth_element(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(most), order_.end(), worse);
    order_.resize(most);
  }
  places_.clear();
  place_points_.count = 0;
  for (const int q : order_) {
    const Vec3d d = atoms.direction(quadrant_atom_[static_cast<std::size_t>(q)]);
    places_.push_back(d);
    place_points_.add(d, Rgbd::Zero(), 0);
  }
  place_points_.finish();
}

double PlaceSearch::cell_cost(const Atoms& atoms, std::span<const double> power) const noexcept {
  double cost = 0, looked_at = 0;
  for (auto k = static_cast<std::size_t>(begin_); k < static_cast<std::size_t>(end_); ++k) {
    const auto share = static_cast<double>(atoms.luminance[k]);
    cost += share * power[static_cast<std::size_t>(nearest_[k])] * static_cast<double>(distance_[k]);
    looked_at += share;
  }
  return looked_at > 0 ? cost / looked_at : 0;
}

}  // namespace lightwell
